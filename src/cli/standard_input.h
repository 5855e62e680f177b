// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace knotreel::cli {

/// The first bytes of standard input, which stay there to be read: up to `count` of a file, and of a pipe as
/// many as come before its writer ends. Nothing of other kinds of input.
/// @throws Error{kInterrupted} after a signal: writers may take their time.
std::vector<std::byte> peek_standard_input(std::size_t count);

/// Makes a named pipe standard input, which can be looked at before it is read.
/// @return "-", once somebody writes to it; of all else the path that was given.
/// @throws Error{kInterrupted} after a signal.
std::string pipe_as_standard_input(const std::string& path);

}  // namespace knotreel::cli
