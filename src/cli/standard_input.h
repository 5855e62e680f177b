#pragma once

#include <cstddef>
#include <vector>

namespace knotreel::cli {

/// The first bytes of standard input, which stay there to be read: up to `count` of a file, and of a pipe as
/// many as come before its writer ends. Nothing of other kinds of input.
/// @throws Error{kInterrupted} after a signal: writers may take their time.
std::vector<std::byte> peek_standard_input(std::size_t count);

}  // namespace knotreel::cli
