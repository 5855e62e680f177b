// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include "knotreel/base/vec2.h"

namespace knotreel::raster {

/// N points of the unit square, a power of two, one in each Nth of both axes (Hammersley): of 64, coverage of
/// an edge of any direction is right to about 1/32, of an upright one to 1/128.
template <std::size_t N>
std::array<Vec2, N> sample_pattern() {
  std::array<Vec2, N> pattern;
  for (std::size_t i = 0; i < N; ++i) {
    std::size_t reversed = 0;
    for (std::size_t bit = 1, mirrored = N / 2; bit < N; bit *= 2, mirrored /= 2) {
      if (i & bit) reversed |= mirrored;
    }
    pattern[i] = {(static_cast<double>(i) + 0.5) / N, (static_cast<double>(reversed) + 0.5) / N};
  }
  return pattern;
}

}  // namespace knotreel::raster
