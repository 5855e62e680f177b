// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <memory>
#include <utility>

#include "knotreel/fit/colour_fit.h"
#include "knotreel/spline/pixel_values.h"

namespace knotreel::fit {

struct DescentOptions {
  int steps = 12;
  double first_step = 0.1;    ///< of a knot, as a share of its shortest edge
  double min_distance = 1.0;  ///< faces keep a quarter of it as their height, if they have that; pixels
  /// Knots on feature segments move along them, too. Colours gain a little by that, but a geometry that is
  /// fitted afterwards follows the curves less well.
  bool along_curves = true;
  ColourFitOptions colour{};
  std::function<void()> on_step{};  ///< called before each step; may throw to stop the work
};

/// A surface without its geometry.
struct ColourSurface {
  std::shared_ptr<const spline::SplineSpace> space;
  ColourFit fit;
};

/// The functions of a space at the places of pixels, which outlive it.
struct SpaceAtPixels {
  SpaceAtPixels(std::shared_ptr<const spline::SplineSpace> space, const Pixels& pixels)
      : basis(std::move(space)), values(basis, pixels.image->width, pixels.image->height, pixels.places) {}
  SpaceAtPixels(const SpaceAtPixels&) = delete;
  SpaceAtPixels& operator=(const SpaceAtPixels&) = delete;

  spline::Basis basis;
  spline::PixelValues values;
};

/// Descent on the true residual: moves the knots against knot_gradient(), each with a step of its
/// own that grows while the gradient keeps its direction and shrinks when it turns, and fits the colours
/// again after each step. Connectivity and links stay. A step may raise the error; the best surface met is
/// returned.
/// @param pixels their places in the domain are held.
/// @param at_pixels the space of the start there, if it is known already; let go of with the first step.
ColourSurface descend(ColourSurface start, const Pixels& pixels, const DescentOptions& options,
                      std::unique_ptr<const SpaceAtPixels> at_pixels = nullptr);

/// Where moves take the knots of a mesh, those on a side or a segment exactly on it.
std::vector<Vec2> moved_positions(const mesh::KnotMesh& mesh, const std::vector<Vec2>& moves);

/// Shrinks moves of knots until no face is flatter than `min_distance` / 4, nor any triangle of a link flat,
/// but for those that are flatter already, which get no flatter.
/// @param mesh  that of the space, with the knots in the places that they move from.
/// @param moves by knot, pixels; changed in place.
void limit_moves(const spline::SplineSpace& space, const mesh::KnotMesh& mesh, double min_distance,
                 std::vector<Vec2>& moves);

}  // namespace knotreel::fit
