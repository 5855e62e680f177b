// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "knotreel/spline/space.h"

namespace knotreel::track {

/// Displacements of the control points of a space, taken over by the ids of their knots from another one; new
/// control points take the mean of those that share a knot with them.
std::vector<Vec2> carried_displacement(const spline::SplineSpace& from, std::span<const Vec2> displacement,
                                       const spline::SplineSpace& to);

}  // namespace knotreel::track
