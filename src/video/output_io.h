// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <string>

#include "knotreel/base/output_file.h"
#include "libav.h"

namespace knotreel::video {

/// An OutputFile as libav's muxers want to see it. Errors of the file cannot pass through libav, so they wait
/// here for rethrow().
class OutputIo {
 public:
  /// @throws Error{kOutput}
  explicit OutputIo(const std::string& path);
  ~OutputIo();
  OutputIo(const OutputIo&) = delete;
  OutputIo& operator=(const OutputIo&) = delete;

  AVIOContext* context() const { return context_; }
  bool seekable() const { return file_.seekable(); }
  const std::string& name() const { return file_.name(); }
  /// Where libav finds what has been written so far; empty if nowhere.
  std::string url() const { return seekable() ? "file:" + file_.place().string() : std::string(); }

  /// Throws what the file has thrown while libav was writing, if anything.
  void rethrow() const;
  void commit();

 private:
  static int on_write(void* self, std::uint8_t* data, int size);
  static std::int64_t on_seek(void* self, std::int64_t offset, int whence);

  OutputFile file_;
  AVIOContext* context_ = nullptr;
  std::int64_t position_ = 0, size_ = 0;
  std::exception_ptr error_;
};

}  // namespace knotreel::video
