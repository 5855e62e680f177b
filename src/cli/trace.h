// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "knotreel/base/output_file.h"
#include "knotreel/pipeline/job.h"

namespace knotreel::cli {

/// The file of `--trace`: an event per stage and frame in the Chrome trace format, for chrome://tracing or
/// Perfetto. It gets its name in finish(); after every row the `.part` file is a whole JSON document, even if
/// the program is killed then. One thread at a time.
class Trace {
 public:
  /// @param path  empty: none. @throws Error{kOutput}, Error{kInvalidArgument} for standard output.
  explicit Trace(const std::string& path);

  void add(const pipeline::FrameRow& row);
  void finish();

 private:
  void write(const std::string& events);

  std::unique_ptr<OutputFile> file_;
  std::uint64_t end_ = 0;  ///< of the events; the closing brackets come after it
  bool first_ = true;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace knotreel::cli
