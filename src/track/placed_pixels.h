// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "knotreel/fit/pixel_places.h"
#include "knotreel/fit/pixels.h"
#include "knotreel/spline/pixel_surface.h"
#include "knotreel/spline/placed_basis.h"

namespace knotreel::track {

/// A picture with the places of its pixels under a geometry.
struct PlacedPixels {
  image::Image picture;        ///< sharp: pixels that features cross have the colours of their side
  std::vector<float> weights;  ///< empty: all 1; those that features cross have little
  std::shared_ptr<const spline::PlacedBasis> placed;

  fit::Pixels view() const { return {.image = &picture, .weights = weights, .places = placed->places()}; }
};

/// A picture whose pixels have known places.
/// @param crossed 1 for pixels that features cross; empty: none.
/// @param edge_softness how soft edges are in the picture (document::FrameModel).
PlacedPixels placed_pixels(const image::Image& picture, std::shared_ptr<const spline::PlacedBasis> placed,
                           std::span<const std::uint8_t> crossed, double edge_softness);

/// The same for the geometry of a surface.
PlacedPixels place_pixels(const std::shared_ptr<const spline::Basis>& basis,
                          std::span<const Vec2> displacement, const image::Image& picture,
                          double edge_softness, const fit::KnownPlaces& known = {});

/// The surface of control points with these colours, function by function, at the pixels.
/// @param kept by tile: 1 for those that are taken from `before`, of a picture of the same size; or none.
std::shared_ptr<const spline::PixelSurface> surface_at(const PlacedPixels& pixels,
                                                       std::span<const double> control,
                                                       std::span<const std::uint8_t> kept = {},
                                                       const spline::PixelSurface* before = nullptr);

/// Picture minus surface; row-major, channels interleaved.
std::vector<float> residual_of(const PlacedPixels& pixels, const spline::PixelSurface& surface);

}  // namespace knotreel::track
