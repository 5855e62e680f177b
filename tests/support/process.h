// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace knotreel::test {

/// How to run a program; see run().
struct ProcessOptions {
  std::string input = {};                  ///< given to its standard input
  bool keep_input_open = false;            ///< it never comes to an end
  std::filesystem::path output_file = {};  ///< its standard output goes there; empty: it is captured
  std::size_t close_output_after = 0;  ///< bytes of standard output after which the pipe is closed; 0: never
  std::filesystem::path signal_once =
      {};                              ///< send `signal` as soon as a file with a name that begins so exists
  std::uintmax_t signal_at_bytes = 0;  ///< ... and is so large
  int signal = 0;                      ///< not before the program has a handler for it
  int second_signal = 0;               ///< sent so long after that; 0: none
  int milliseconds_between = 600;
  std::uintmax_t max_file_bytes = 0;  ///< files cannot grow beyond; 0: no limit
};

struct ProcessResult {
  int exit_code = -1;  ///< 128 + signal if a signal ended it
  std::string out;
  std::string err;
  std::size_t peak_memory_bytes = 0;  ///< largest resident set
};

/// Runs a program and waits for it, at most 60 s; then it is killed and the exit code is 137.
ProcessResult run(const std::vector<std::string>& command, const ProcessOptions& options = {});

}  // namespace knotreel::test
