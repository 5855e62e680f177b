// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/frame_stream.h"

#include <ostream>

#include "document/container.h"
#include "document/frame_codec.h"
#include "knotreel/base/error.h"
#include "knotreel/base/ticks.h"

namespace knotreel::document {

FrameStream::FrameStream(std::ostream& out, const Format& format) : format_(format), out_(out) {
  put(preamble());
  put(chunk(ChunkType::kHeader, write_header(format_)));
  flush();
}

void FrameStream::put(FrameState& state, const FrameState* before) {
  require_open();
  if (!records_.empty() && state.pts <= records_.back().pts) {
    throw Error(ErrorKind::kInvalidArgument,
                "cannot store a frame: its time is not after that of the frame before");
  }
  const std::vector<std::byte> bytes = chunk(ChunkType::kFrame, encode_frame(state, before, format_));
  const FrameRecord record{position_, bytes.size(), state.frame, state.pts, state.keyframe};
  put(bytes);
  flush();
  records_.push_back(record);
}

void FrameStream::finish(std::int64_t last_duration) {
  require_open();
  finished_ = true;
  if (last_duration > 0 && is_time(last_duration)) put(chunk(ChunkType::kLast, write_last(last_duration)));
  ByteWriter end;
  end.u64(position_);
  put(chunk(ChunkType::kIndex, write_index(records_)));
  put(chunk(ChunkType::kEnd, end.view()));
  flush();
}

void FrameStream::require_open() const {
  if (finished_)
    throw Error(ErrorKind::kInvalidArgument, "the document is finished already, or could not be written");
}

void FrameStream::put(const std::vector<std::byte>& bytes) {
  out_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  position_ += bytes.size();
}

/// After a failed write the last chunk may be cut off, so nothing must follow it.
void FrameStream::flush() {
  if (out_.flush()) return;
  finished_ = true;
  throw Error(ErrorKind::kOutput, "the document cannot be written");
}

}  // namespace knotreel::document
