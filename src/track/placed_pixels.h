#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/fit/pixels.h"
#include "knotreel/spline/basis.h"

namespace knotreel::track {

/// A picture with the places of its pixels under a geometry.
struct PlacedPixels {
  image::Image picture;        ///< pixels that features cross have the colours of their side
  std::vector<float> weights;  ///< empty: all 1; those that features cross have little
  std::vector<Vec2> places;    ///< empty: the centres

  fit::Pixels view() const { return {.image = &picture, .weights = weights, .places = places}; }
};

/// A picture whose pixels have known places.
/// @param mesh its segments are the features. @param crossed 1 for pixels that features cross; empty: none.
PlacedPixels placed_pixels(const image::Image& picture, const mesh::KnotMesh& mesh, std::vector<Vec2> places,
                           std::span<const std::uint8_t> crossed);

/// The same for the geometry of a surface, within a few hundredths of a pixel.
PlacedPixels place_pixels(const spline::Basis& basis, std::span<const Vec2> displacement,
                          const image::Image& picture);

}  // namespace knotreel::track
