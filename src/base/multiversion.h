// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// KNOTREEL_MULTIVERSION before a function with plain loops compiles it for several x86-64 levels and picks
// one at program start, so that one binary uses wide vectors where they exist. Without fused multiply-add
// (see cmake/compiler.cmake) all versions give the same bits. Sanitizers start too late for the resolvers.
//
// Vector types of a fixed width must not be wider than the vectors of the machine: GCC 12 takes those through
// memory, element by element. Where that is told by the profile, KNOTREEL_WIDE compiles a function for
// vectors of 256 bits, to be called only if has_wide_vectors(); where it is not defined there are 128 bits.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define KNOTREEL_MULTIVERSION __attribute__((target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")))
#define KNOTREEL_WIDE __attribute__((target("avx2")))

namespace knotreel {

inline bool has_wide_vectors() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx2") != 0;
}

}  // namespace knotreel
#else
#define KNOTREEL_MULTIVERSION
#endif
