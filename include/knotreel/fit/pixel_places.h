#pragma once

#include <memory>
#include <span>
#include <vector>

#include "knotreel/spline/placed_basis.h"

namespace knotreel::fit {

/// Where the pixel centres of a picture lie in the parametric domain under a geometry, to some 1e-3 of a
/// pixel, and exactly at the centre where the geometry is the identity. Where it reaches no centre, or folds,
/// some place that goes to nearby.
/// @param width, height of the picture, in pixels: those of the domain. @return row-major.
std::vector<Vec2> pixel_places(const spline::Basis& basis, std::span<const Vec2> displacement, int width,
                               int height);

/// A basis at the places of the pixels of a picture of the size of the domain: none if there are no features
/// and nothing is displaced.
std::shared_ptr<const spline::PlacedBasis> place_basis(std::shared_ptr<const spline::Basis> basis,
                                                       std::span<const Vec2> displacement);

}  // namespace knotreel::fit
