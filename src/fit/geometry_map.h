#pragma once

#include <span>
#include <vector>

#include "fit/damped_newton.h"
#include "knotreel/spline/basis.h"

namespace knotreel::fit {

/// The geometry part of a surface, point by point.
class GeometryMap {
 public:
  GeometryMap(const spline::Basis& basis, std::span<const Vec2> displacement);

  /// Displacements by function, not by geometry group.
  const std::vector<Vec2>& by_function() const { return by_function_; }

  /// The nearest point of the domain.
  Vec2 clamped(Vec2 u) const;

  /// The point that is taken to `target`, by damped steps of Newton's method from `start` and, if they get
  /// stuck, from around the target; where the surface does not reach the target, the nearest that was found.
  /// @param jets working memory.
  Vec2 place_of(Vec2 target, Vec2 start, std::vector<spline::BasisJet>& jets) const;

 private:
  MapValue at(Vec2 u, std::vector<spline::BasisJet>& jets) const;

  const spline::Basis& basis_;
  std::vector<Vec2> by_function_;
};

}  // namespace knotreel::fit
