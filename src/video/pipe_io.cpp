// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipe_io.h"

#include <algorithm>
#include <array>
#include <cstdio>

#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"

namespace knotreel::video {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 30;
constexpr int kPipeBytes = 32 * 1024;

/// The first bytes, which stay there to be read.
std::string start_of(AVIOContext& pipe) {
  std::string start(PipeIo::kStart, '\0');
  const int got = avio_read(&pipe, reinterpret_cast<unsigned char*>(start.data()), int(start.size()));
  if (got > 0) avio_seek(&pipe, 0, SEEK_SET);
  start.resize(std::size_t(std::max(got, 0)));
  return start;
}

}  // namespace

PipeIo::PipeIo(const std::string& url, const std::string& cannot_read) {
  const int result = avio_open2(&pipe_, url.c_str(), AVIO_FLAG_READ, nullptr, nullptr);
  if (result < 0) throw Error(ErrorKind::kInput, cannot_read + error_text(result));
  try {
    start_ = start_of(*pipe_);
    if (start_.starts_with("GIF8")) read_all(cannot_read);
  } catch (...) {
    avio_close(pipe_);
    throw;
  }
}

PipeIo::~PipeIo() {
  avio_close(pipe_);
  if (memory_ == nullptr) return;
  av_freep(&memory_->buffer);
  avio_context_free(&memory_);
}

void PipeIo::read_all(const std::string& cannot_read) {
  std::array<unsigned char, kPipeBytes> part;
  for (;;) {
    const int got = avio_read(pipe_, part.data(), int(part.size()));
    check_while_working();
    if (got == 0 || got == AVERROR_EOF) break;
    if (got < 0) throw Error(ErrorKind::kInput, cannot_read + error_text(got));
    bytes_.insert(bytes_.end(), part.begin(), part.begin() + got);
    if (bytes_.size() > kMostBytes)
      throw Error(ErrorKind::kInput, cannot_read + "a GIF from a pipe may have up to 1 GiB");
  }
  auto* buffer = static_cast<unsigned char*>(allocated(av_malloc(kPipeBytes)));
  memory_ = avio_alloc_context(buffer, kPipeBytes, 0, this, on_read, nullptr, on_seek);
  if (memory_ != nullptr) return;
  av_free(buffer);
  throw std::bad_alloc();
}

int PipeIo::on_read(void* self, std::uint8_t* data, int size) {
  auto& io = *static_cast<PipeIo*>(self);
  const std::int64_t left = std::int64_t(io.bytes_.size()) - io.position_;
  const auto count = int(std::min<std::int64_t>(size, left));
  if (count <= 0) return AVERROR_EOF;
  std::copy_n(io.bytes_.begin() + io.position_, count, data);
  io.position_ += count;
  return count;
}

std::int64_t PipeIo::on_seek(void* self, std::int64_t offset, int whence) {
  auto& io = *static_cast<PipeIo*>(self);
  const auto size = std::int64_t(io.bytes_.size());
  if (whence == AVSEEK_SIZE) return size;
  if (whence == SEEK_CUR) offset += io.position_;
  if (whence == SEEK_END) offset += size;
  if (offset < 0 || offset > size) return AVERROR(EINVAL);
  return io.position_ = offset;
}

}  // namespace knotreel::video
