#pragma once

#include <cstdint>

namespace knotreel::document {

/// Knots of a document lie on a grid of 2^-bits px.
inline constexpr int kMinKnotBits = 0;
inline constexpr int kMaxKnotBits = 14;

/// Times of frames in ticks, either way. Sums and differences of some are far from the ends of 64 bits, and
/// doubles hold them exactly.
inline constexpr std::int64_t kMaxPts = std::int64_t{1} << 53;

constexpr bool is_time(std::int64_t ticks) {
  return ticks >= -kMaxPts && ticks <= kMaxPts;
}

}  // namespace knotreel::document
