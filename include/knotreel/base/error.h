// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace knotreel {

/// What went wrong, in the classes that decide the exit code of the program (README).
enum class ErrorKind {
  kInvalidArgument,  ///< a function or the program was called wrongly (exit 2 from the command line)
  kInput,            ///< an input cannot be read, is corrupt, or is of an unknown kind or version (exit 3)
  kOutput,           ///< an output cannot be written (exit 4)
  kInterrupted,      ///< stopped by the user (exit 130)
  kInternal,         ///< anything else (exit 1)
};

/// The only exception type that the library throws on purpose. The layer that knows the cause writes the
/// message, once: one line, saying what, where, and what to do; no trailing full stop.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}

  ErrorKind kind() const noexcept { return kind_; }

 private:
  ErrorKind kind_;
};

/// Exit code of the program for an error kind: 0 is never returned.
int exit_code(ErrorKind kind) noexcept;

}  // namespace knotreel
