// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/fit/geometry_fit.h"
#include "knotreel/spline/space.h"

namespace knotreel::fit {

/// A part of what is asked of displacements.
struct GeometryTerm {
  std::uint32_t group = 0;  ///< of geometry, as SplineSpace::geometry_of()
  double factor = 0;
};

/// Says that a feature curve goes on without a bend where two of its segments meet: the control point of
/// their knot lies between the next ones along both, as far from them as the Greville sites are. The sum of
/// factors times displacements is what is wanted.
struct JointEquation {
  std::array<GeometryTerm, 3> terms;  ///< that of the knot first
  Vec2 wanted;                        ///< pixels
};

/// Where the points say that there is a joint.
std::vector<Vec2> joints_of(std::span<const CurvePoint> points);

/// @param joints where segments should meet like that, in the domain, within half a pixel (documents round
/// knots). There is no equation where that are not two segments, and none for degree 1.
std::vector<JointEquation> joint_equations(const spline::SplineSpace& space, std::span<const Vec2> joints);

}  // namespace knotreel::fit
