// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "knotreel/pipeline/job.h"

namespace knotreel::cli {

/// The file of `--trace`: an event per stage and frame in the Chrome trace format, for chrome://tracing or
/// Perfetto. After every row it is a whole JSON document, even if the program is killed then. One thread at a
/// time.
class Trace {
 public:
  /// @param path  of a file, which must be seekable; empty: none. @throws Error{kOutput}.
  explicit Trace(const std::string& path);
  ~Trace();
  Trace(const Trace&) = delete;
  Trace& operator=(const Trace&) = delete;

  void add(const pipeline::FrameRow& row);

 private:
  /// Whole when it has got here, so that the file is closed if nothing can be written to it.
  Trace(const std::string& path, int descriptor) : path_(path), descriptor_(descriptor) {}
  void write(const std::string& events);

  std::string path_;
  int descriptor_ = -1;
  std::int64_t end_ = 0;  ///< of the events; the closing brackets come after it
  bool first_ = true;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace knotreel::cli
