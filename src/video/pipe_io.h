// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "libav.h"

namespace knotreel::video {

/// A pipe for libav's demuxers. That of GIF reads a file to its end and then goes back to its start, so a GIF
/// is read into memory first; of all else only the buffer is kept.
class PipeIo {
 public:
  /// @param url  as libav names it. @param cannot_read  start of messages.
  /// @throws Error{kInput} if it cannot be read, or is a GIF of more than 1 GiB.
  PipeIo(const std::string& url, const std::string& cannot_read);
  ~PipeIo();
  PipeIo(const PipeIo&) = delete;
  PipeIo& operator=(const PipeIo&) = delete;

  bool in_memory() const { return memory_ != nullptr; }
  /// All that is in memory.
  std::string text() const { return {bytes_.begin(), bytes_.end()}; }

  /// The first bytes, up to kStart of them.
  const std::string& start() const { return start_; }
  static constexpr std::size_t kStart = 256;

  AVIOContext* context() const { return memory_ != nullptr ? memory_ : pipe_; }

 private:
  void read_all(const std::string& cannot_read);
  static int on_read(void* self, std::uint8_t* data, int size);
  static std::int64_t on_seek(void* self, std::int64_t offset, int whence);

  AVIOContext* pipe_ = nullptr;
  AVIOContext* memory_ = nullptr;  ///< of a GIF
  std::string start_;
  std::vector<std::uint8_t> bytes_;
  std::int64_t position_ = 0;
};

}  // namespace knotreel::video
