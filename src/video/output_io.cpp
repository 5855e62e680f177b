// SPDX-License-Identifier: GPL-3.0-or-later
#include "output_io.h"

#include <algorithm>
#include <cstdio>
#include <span>

namespace knotreel::video {
namespace {
// libav writes in many small pieces, and not through the buffer of OutputFile where it may seek.
constexpr int kBufferBytes = 256 * 1024;
}  // namespace

OutputIo::OutputIo(const std::string& path) : file_(path) {
  auto* buffer = static_cast<unsigned char*>(allocated(av_malloc(kBufferBytes)));
  context_ =
      avio_alloc_context(buffer, kBufferBytes, 1, this, nullptr, on_write, seekable() ? on_seek : nullptr);
  if (context_ != nullptr) return;
  av_free(buffer);
  throw std::bad_alloc();
}

OutputIo::~OutputIo() {
  av_freep(&context_->buffer);
  avio_context_free(&context_);
}

void OutputIo::rethrow() const {
  if (error_) std::rethrow_exception(error_);
}

void OutputIo::commit() {
  avio_flush(context_);
  rethrow();
  file_.commit();
}

int OutputIo::on_write(void* self, std::uint8_t* data, int size) {
  auto& io = *static_cast<OutputIo*>(self);
  if (io.error_) return AVERROR(EIO);
  try {
    const auto bytes = std::as_bytes(std::span(data, std::size_t(size)));
    if (io.seekable()) {
      io.file_.write_at(std::uint64_t(io.position_), bytes);
    } else {
      io.file_.write(bytes);
    }
  } catch (...) {
    io.error_ = std::current_exception();
    return AVERROR(EIO);
  }
  io.position_ += size;
  io.size_ = std::max(io.size_, io.position_);
  return size;
}

std::int64_t OutputIo::on_seek(void* self, std::int64_t offset, int whence) {
  auto& io = *static_cast<OutputIo*>(self);
  if (whence == AVSEEK_SIZE) return io.size_;
  if (whence == SEEK_CUR) offset += io.position_;
  if (whence == SEEK_END) offset += io.size_;
  if (offset < 0) return AVERROR(EINVAL);
  return io.position_ = offset;
}

}  // namespace knotreel::video
