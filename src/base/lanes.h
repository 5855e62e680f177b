// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace knotreel {

/// N values side by side, for loops that are written with vectors. A vector should not be wider than those of
/// the machine (256 bits in a function with KNOTREEL_MULTIVERSION): GCC 12 takes wider ones through memory,
/// element by element.
template <class Value, std::size_t N>
struct LanesOf {
  using Type [[gnu::vector_size(N * sizeof(Value))]] = Value;
  using Anywhere [[gnu::vector_size(N * sizeof(Value)), gnu::aligned(alignof(Value)), gnu::may_alias]] =
      Value;

  /// Reads and writes N values one after the other. Not std::memcpy: GCC 12 copies 16 bytes at a time for
  /// x86-64-v3, by way of the stack, and what reads 32 of them waits until both halves are there.
  [[gnu::always_inline]] static void load(const Value* from, Type& lanes) {
    lanes = *reinterpret_cast<const Anywhere*>(from);
  }
  [[gnu::always_inline]] static void store(const Type& lanes, Value* to) {
    *reinterpret_cast<Anywhere*>(to) = lanes;
  }
};

}  // namespace knotreel
