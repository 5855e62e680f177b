// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/document/sequence_info.h"

namespace knotreel::document {

/// Where a frame lies in the file.
struct FrameRecord {
  std::uint64_t offset = 0;  ///< of its chunk
  std::uint64_t bytes = 0;   ///< of its chunk, all in
  std::uint64_t frame = 0;   ///< FrameModel::frame
  std::int64_t pts = 0;      ///< FrameModel::pts
  bool keyframe = false;

  friend bool operator==(const FrameRecord&, const FrameRecord&) = default;
};

/// What the numbers of a document are multiples of.
struct Steps {
  std::uint32_t colour = 0;        ///< in 1/512 level, 1 to 65535
  std::uint32_t displacement = 0;  ///< in 1/4096 px, 1 to 65535

  friend bool operator==(const Steps&, const Steps&) = default;
};

/// Reads documents, also unfinished ones up to their last whole frame. Holds one decoded frame, so reading in
/// order costs one frame each, and reading elsewhere starts from the keyframe before. Not safe to use from
/// several threads; several readers of one file are.
///
/// A damaged document throws Error{kInput} with path, defect and offset, on open or on read. Whatever the
/// bytes, memory stays below 1 MiB + 1024 x file size (docs/format.md, "Bounds").
class Reader {
 public:
  /// @throws Error{kInput} if the file cannot be read, is no document, of another version, damaged, or has no
  /// whole frame.
  static Reader open(const std::filesystem::path& path);

  /// The same from memory; `name` stands for the path in messages.
  static Reader open(std::vector<std::byte> bytes, std::string name = "document");

  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;

  /// What all frames have in common; valid as long as the reader.
  const SequenceInfo& info() const;

  /// Frames in the file: all if complete(), else those that were whole when it was opened.
  std::size_t frame_count() const;

  /// False if the file was not finished (cut off, or still being written).
  bool complete() const;

  /// Largest error of a control colour of a keyframe, levels.
  double colour_tolerance() const;

  /// As stored. Colours of a frame may be multiples of several times the step (FrameModel::colour_step).
  Steps steps() const;

  /// Size of the whole file when it was opened, a part that is cut off included.
  std::uint64_t file_bytes() const;

  /// Ticks that the last frame is shown; 0 if the document does not tell.
  std::int64_t last_duration() const;

  /// @throws Error{kInvalidArgument} if there is no such frame.
  const FrameRecord& record(std::size_t frame) const;

  /// @param frame  place in the document, from 0. @throws Error{kInvalidArgument} if there is no such frame,
  /// Error{kInput} if it is damaged.
  FrameModel read(std::size_t frame);

 private:
  friend class Copier;
  class Impl;
  explicit Reader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace knotreel::document
