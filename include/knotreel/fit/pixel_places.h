// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "knotreel/spline/placed_basis.h"

namespace knotreel::fit {

/// What is known of a tile of 8x8 pixels (spline::PixelTiles).
enum class PlacesOfTile : std::uint8_t {
  kUnknown,
  kKnown,     ///< and there are tiles near by of which they are not
  kAllKnown,  ///< here and near by: nothing needs to be looked at
};

/// Places of pixels that were found before, where functions and geometry are still the same.
struct KnownPlaces {
  std::span<const Vec2> places;         ///< of all pixels; or none
  std::span<const PlacesOfTile> tiles;  ///< by tile; or none
  std::span<const std::uint8_t>
      functions;  ///< by function: 0 for those that reach no other tile than kAllKnown
};

/// Where the pixel centres of a picture lie in the parametric domain under a geometry, to some 1e-3 of a
/// pixel, and exactly at the centre where the geometry is the identity. Where it reaches no centre, or folds,
/// some place that goes to nearby.
/// @param width, height of the picture, in pixels: those of the domain.
/// @param known  taken as it is; only other pixels are looked for. @return row-major.
std::vector<Vec2> pixel_places(const spline::Basis& basis, std::span<const Vec2> displacement, int width,
                               int height, const KnownPlaces& known = {});

/// A basis at the places of the pixels of a picture of the size of the domain: none if there are no features
/// and nothing is displaced.
std::shared_ptr<const spline::PlacedBasis> place_basis(std::shared_ptr<const spline::Basis> basis,
                                                       std::span<const Vec2> displacement,
                                                       const KnownPlaces& known = {});

}  // namespace knotreel::fit
