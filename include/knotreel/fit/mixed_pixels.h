// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "knotreel/base/vec2.h"

namespace knotreel::fit {

/// Pixels that features cross. The colour of each is a mean over places on all sides of the features, as it
/// is drawn: a row of its own of the least-squares problem (docs/decisions/0038).
struct MixedPixels {
  std::vector<std::uint32_t> pixels;  ///< row-major numbers in the picture, ascending
  std::vector<std::size_t> begin;     ///< by pixel, of its places; and their number
  std::vector<Vec2> places;           ///< in the parametric domain
  std::vector<double> shares;         ///< by place, of its pixel; those of a pixel sum to 1
  std::vector<double> weights;        ///< by pixel, 0 or more; others have 1
  std::vector<float> colours;         ///< by pixel, channels interleaved
};

}  // namespace knotreel::fit
