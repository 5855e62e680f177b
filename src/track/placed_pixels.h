#pragma once

#include <span>
#include <vector>

#include "knotreel/fit/pixel_values.h"

namespace knotreel::track {

/// A picture with the places of its pixels under a geometry.
struct PlacedPixels {
  image::Image picture;        ///< pixels that features cross have the colours of their side
  std::vector<float> weights;  ///< empty: all 1; those that features cross have little
  std::vector<Vec2> places;    ///< empty: the centres

  fit::Pixels view() const { return {.image = &picture, .weights = weights, .places = places}; }
};

PlacedPixels place_pixels(const spline::Basis& basis, std::span<const Vec2> displacement,
                          const image::Image& picture);

}  // namespace knotreel::track
