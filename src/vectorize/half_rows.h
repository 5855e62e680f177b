// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "knotreel/fit/pixels.h"

namespace knotreel::vectorize {

/// Pixels with their own storage.
struct PixelData {
  image::Image image;
  std::vector<float> weights;  ///< empty: all 1
  std::vector<Vec2> places;    ///< empty: the centres

  fit::Pixels view() const { return {.image = &image, .weights = weights, .places = places}; }
};

/// The picture with every two rows made one, for fits that only steer the knots: half the work, and still a
/// dozen pixels per control point. Pairs of ordinary pixels become their mean; of the others the one with the
/// larger weight stays, at its place.
/// @param pixels of a picture with an even number of rows.
PixelData half_rows(const fit::Pixels& pixels);

}  // namespace knotreel::vectorize
