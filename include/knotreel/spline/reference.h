// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/spline/space.h"

/// The slow, obvious evaluation by the recurrence of the paper (Eq. 1-3): what every fast path is tested
/// against.
namespace knotreel::spline {

/// The one-sided direction that stands for "inside" at u: a fixed generic direction, reflected where u lies
/// on the right or lower side of the domain. Points on knot lines are evaluated as limits from this side.
Vec2 inward_direction(Vec2 u, double width, double height);

/// Value, gradient and Hessian at a point; units of the function per pixel and per squared pixel.
struct Jet {
  double value = 0;
  double dx = 0;
  double dy = 0;
  double dxx = 0;
  double dxy = 0;
  double dyy = 0;

  bool operator==(const Jet&) const = default;
};

/// All basis functions of a space by the recurrence (paper Eq. 3). Holds the degree-k t-configs.
class ReferenceBasis {
 public:
  explicit ReferenceBasis(const SplineSpace& space);

  /// B_f(u) and its derivatives. Thread safe.
  Jet evaluate(FunctionIndex f, Vec2 u, Vec2 direction) const;

  /// All functions at u, from the side of inward_direction(u).
  std::vector<Jet> evaluate_all(Vec2 u) const;

 private:
  const SplineSpace& space_;
  std::vector<std::vector<std::array<CornerIndex, 3>>> triangles_;
  std::vector<std::pair<Vec2, Vec2>> boxes_;  ///< of the knots of each function, outside of which it is zero
};

}  // namespace knotreel::spline
