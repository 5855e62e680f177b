// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

namespace knotreel {

/// A point or vector of the plane, double precision. Unit: pixels of the source image unless said otherwise;
/// x to the right, y down, the top left corner of the image is (0,0) and pixel (i,j) has its centre at
/// (i+0.5, j+0.5).
struct Vec2 {
  double x = 0;
  double y = 0;

  friend bool operator==(const Vec2&, const Vec2&) = default;
};

inline Vec2 operator+(Vec2 a, Vec2 b) {
  return {a.x + b.x, a.y + b.y};
}
inline Vec2 operator-(Vec2 a, Vec2 b) {
  return {a.x - b.x, a.y - b.y};
}
inline Vec2 operator*(double s, Vec2 a) {
  return {s * a.x, s * a.y};
}
inline double dot(Vec2 a, Vec2 b) {
  return a.x * b.x + a.y * b.y;
}

/// z component of the cross product: positive when b is counter-clockwise of a in a frame with y up.
inline double cross(Vec2 a, Vec2 b) {
  return a.x * b.y - a.y * b.x;
}
inline double norm(Vec2 a) {
  return std::sqrt(dot(a, a));
}

/// The same direction with length 1. Not zero.
inline Vec2 unit(Vec2 a) {
  return (1 / norm(a)) * a;
}

/// From a to b, -pi to pi; positive as cross(). Neither is zero.
inline double angle_between(Vec2 a, Vec2 b) {
  return std::atan2(cross(a, b), dot(a, b));
}

/// By an angle in radians, positive as angle_between().
inline Vec2 turned(Vec2 a, double angle) {
  return {std::cos(angle) * a.x - std::sin(angle) * a.y, std::sin(angle) * a.x + std::cos(angle) * a.y};
}

/// The ends may be one point.
inline double distance_to_segment(Vec2 p, Vec2 a, Vec2 b) {
  const double squared = dot(b - a, b - a);
  const double t = squared > 0 ? std::clamp(dot(p - a, b - a) / squared, 0.0, 1.0) : 0;
  return norm(p - (a + t * (b - a)));
}

/// Signed area of the triangle (a,b,c); this sign is what "counter-clockwise" means in the whole library.
inline double signed_area(Vec2 a, Vec2 b, Vec2 c) {
  return 0.5 * cross(b - a, c - a);
}

}  // namespace knotreel
