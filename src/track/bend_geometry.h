// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/fit/geometry_fit.h"

namespace knotreel::track {

/// How a sheet resists, relative to the weight of a point of a curve.
struct Sheet {
  double stiffness = 3;     ///< of the difference of two neighbours' changes over their distance
  double elasticity = 0.3;  ///< of that of their displacements
  double inertia = 0.05;    ///< of the change of a control point
};

/// Changes the geometry so that points of curves come to lie where they belong. The control points around the
/// curves follow as those of an elastic sheet would, so that thin faces beside a curve are not turned over:
/// least squares over the points, the differences between neighbours, and, much weaker, the displacements and
/// their changes, so that large faces stay where they are. Farther away displacements fade from call to call.
/// Control points on the sides of the picture stay.
/// @param displacement by geometry control point; changed in place.
/// @param held by geometry control point: 1 for those that stay as they are; or none.
void bend_geometry(const spline::Basis& basis, std::span<const fit::CurvePoint> points,
                   std::vector<Vec2>& displacement, std::span<const std::uint8_t> held = {},
                   const Sheet& sheet = {});

}  // namespace knotreel::track
