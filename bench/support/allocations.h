// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace knotreel::bench {

/// What malloc() and calloc() were asked for, by operator new, Eigen and all others in this process.
struct Allocations {
  std::uint64_t calls = 0;
  std::uint64_t bytes = 0;
};

/// Since the start of the program, on all threads. All zero where the C library is not glibc.
Allocations allocations();

}  // namespace knotreel::bench
