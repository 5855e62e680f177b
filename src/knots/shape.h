// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "knotreel/base/vec2.h"

/// Shapes of triangles.
namespace knotreel::knots {

/// Corner with the largest angle: opposite the longest side, the first one of equals.
inline std::size_t widest_corner(const std::array<Vec2, 3>& t) {
  const std::array<double, 3> opposite{norm(t[2] - t[1]), norm(t[0] - t[2]), norm(t[1] - t[0])};
  return static_cast<std::size_t>(std::max_element(opposite.begin(), opposite.end()) - opposite.begin());
}

inline double sine_of_degrees(double angle) {
  return std::sin(angle * std::numbers::pi / 180);
}

/// Whether an angle is smaller than one of this sine; if an angle is larger than 180 degrees less that,
/// another one is smaller too.
inline bool is_sliver(const std::array<Vec2, 3>& t, double least_sine) {
  const double a = norm(t[2] - t[1]);
  const double b = norm(t[0] - t[2]);
  const double c = norm(t[1] - t[0]);
  return 2 * signed_area(t[0], t[1], t[2]) < least_sine * std::max({a * b, b * c, c * a});
}

}  // namespace knotreel::knots
