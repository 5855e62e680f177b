// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "document/byte_source.h"
#include "document/container.h"
#include "document/frame_codec.h"

namespace knotreel::document {

/// The engine of Reader. Checksums can be ignored, so that fuzzing and tests reach what lies beneath them.
class DocumentFile {
 public:
  DocumentFile(std::unique_ptr<ByteSource> source, bool verify_checksums);

  const Format& format() const { return format_; }
  const std::vector<FrameRecord>& records() const { return records_; }
  bool complete() const { return complete_; }
  std::uint64_t bytes() const { return source_->size(); }
  std::int64_t last_duration() const { return last_duration_; }

  /// @pre frame < records().size(). Valid until the next call.
  const FrameState& read(std::size_t frame);

 private:
  struct Chunk {
    ChunkHeader header;
    std::vector<std::byte> payload;
  };

  void open();
  bool read_with_index();
  void read_behind_frames(std::uint64_t offset, std::uint64_t end);
  void scan();
  /// @return nothing if the file ends before the chunk does.
  std::optional<ChunkHeader> header_at(std::uint64_t offset);
  std::vector<std::byte> payload_at(std::uint64_t offset, const ChunkHeader& header);
  void decode(std::size_t frame);

  /// Runs `body`; what it finds malformed becomes an Error with path and offset.
  template <class Body>
  auto located(const std::uint64_t& offset, Body body);

  std::unique_ptr<ByteSource> source_;
  bool verify_;
  Format format_;
  std::vector<FrameRecord> records_;
  std::uint64_t first_chunk_ = 0;  ///< behind the header chunk
  std::int64_t last_duration_ = 0;
  bool complete_ = false;
  std::optional<FrameState> state_;
  std::size_t state_frame_ = 0;
};

}  // namespace knotreel::document
