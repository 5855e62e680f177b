// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <iosfwd>
#include <vector>

#include "document/frame_state.h"
#include "knotreel/document/reader.h"

namespace knotreel::document {

/// The bytes of a document in the order of the file: header, frames, index.
class FrameStream {
 public:
  /// Writes the header. @throws Error{kOutput} if writing fails, as all that follows.
  FrameStream(std::ostream& out, const Format& format);

  /// @param state, before  as encode_frame() takes them.
  void put(FrameState& state, const FrameState* before);

  /// Writes the index, last. @param last_duration  ticks that the last frame lasts; 0: the document does not
  /// tell.
  void finish(std::int64_t last_duration);

  /// @throws Error{kInvalidArgument} if nothing may follow.
  void require_open() const;

 private:
  void put(const std::vector<std::byte>& bytes);
  void flush();

  const Format& format_;
  std::ostream& out_;
  std::uint64_t position_ = 0;
  std::vector<FrameRecord> records_;
  bool finished_ = false;
};

}  // namespace knotreel::document
