// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "fit/damped_newton.h"
#include "knotreel/spline/basis.h"

namespace knotreel::fit {

/// Displacements as control points of a surface with two channels: by function, not by geometry group.
std::vector<double> displacement_control(const spline::SplineSpace& space,
                                         std::span<const Vec2> displacement);

/// The geometry part of a surface, point by point.
class GeometryMap {
 public:
  GeometryMap(const spline::Basis& basis, std::span<const Vec2> displacement);

  /// The nearest point of the domain.
  Vec2 clamped(Vec2 u) const;

  /// The point that is taken to `target`, by damped steps of Newton's method from `start` and, if they get
  /// stuck, from around the target; where the surface does not reach the target, the nearest that was found.
  Vec2 place_of(Vec2 target, Vec2 start) const;

 private:
  MapValue at(Vec2 u) const;

  const spline::Basis& basis_;
  std::vector<double> control_;
};

}  // namespace knotreel::fit
