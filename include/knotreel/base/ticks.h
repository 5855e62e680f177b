// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace knotreel {

/// Times of frames in ticks, either way. Sums and differences of some are far from the ends of 64 bits, and
/// doubles hold them exactly.
inline constexpr std::int64_t kMaxTicks = std::int64_t{1} << 53;

/// Whether a number of ticks, which a file may tell as it likes, is a time; libav's AV_NOPTS_VALUE is none.
constexpr bool is_time(std::int64_t ticks) {
  return ticks >= -kMaxTicks && ticks <= kMaxTicks;
}

}  // namespace knotreel
