// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace knotreel::cli {

/// Largest resident set of this process so far, in bytes; 0 if the system does not tell. What getrusage()
/// tells is no use in a child process: it counts the parent that it was forked from.
std::uint64_t peak_memory_bytes();

}  // namespace knotreel::cli
