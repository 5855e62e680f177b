#pragma once

#include <span>
#include <vector>

#include "knotreel/fit/geometry_fit.h"

namespace knotreel::track {

/// Changes the geometry so that points of curves come to lie where they belong, as little as that takes:
/// least squares over the points and, much weaker, over the changes of the control points. Those on the sides
/// of the picture stay.
/// @param displacement by geometry control point; changed in place.
void bend_geometry(const spline::Basis& basis, std::span<const fit::CurvePoint> points,
                   std::vector<Vec2>& displacement);

}  // namespace knotreel::track
