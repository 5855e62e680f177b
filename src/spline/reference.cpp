// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/reference.h"

#include <algorithm>
#include <cmath>

namespace knotreel::spline {

namespace {

// A point this close to a line, in pixels, is on it and takes the side of the direction: collinear knots of a
// feature are collinear only up to rounding.
constexpr double kOnLine = 1e-9;
// Triangles thinner than this, relative to their squared diameter, are flat.
constexpr double kThin = 1e-11;

struct Simplex {
  std::array<Vec2, 6> knots;
  std::size_t count;

  Simplex without(std::size_t j) const {
    Simplex s{};
    for (std::size_t i = 0; i < count; ++i) {
      if (i != j) s.knots[s.count++] = knots[i];
    }
    return s;
  }
};

/// Whether u + eps * direction is on the positive side of the line a -> b.
bool left_of(Vec2 a, Vec2 b, Vec2 u, Vec2 direction) {
  const bool swap = b.x < a.x || (b.x == a.x && b.y < a.y);
  const Vec2 from = swap ? b : a;
  const Vec2 edge = swap ? a - b : b - a;
  double side = cross(edge, u - from);
  if (std::abs(side) <= kOnLine * norm(edge)) side = cross(edge, direction);
  return (side > 0) != swap;
}

bool contains(Vec2 a, Vec2 b, Vec2 c, Vec2 u, Vec2 direction) {
  const bool ab = left_of(a, b, u, direction);
  return ab == left_of(b, c, u, direction) && ab == left_of(c, a, u, direction);
}

/// The three knots that span the largest area, or nothing above the flatness bound.
bool largest_triangle(const Simplex& s, std::array<std::size_t, 3>& best) {
  double largest = 0;
  double diameter2 = 0;
  for (std::size_t i = 0; i < s.count; ++i) {
    for (std::size_t j = i + 1; j < s.count; ++j) {
      diameter2 = std::max(diameter2, dot(s.knots[j] - s.knots[i], s.knots[j] - s.knots[i]));
      for (std::size_t k = j + 1; k < s.count; ++k) {
        const double area = std::abs(signed_area(s.knots[i], s.knots[j], s.knots[k]));
        if (area > largest) {
          largest = area;
          best = {i, j, k};
        }
      }
    }
  }
  return largest > kThin * diameter2;
}

/// Simplex spline M(u | knots) of degree count - 3 (paper Eq. 1, 2), as the limit from the side of
/// `direction`; zero if the knots span no area. Cost 3^degree.
Jet evaluate(const Simplex& s, Vec2 u, Vec2 direction) {
  std::array<std::size_t, 3> t{};
  if (!largest_triangle(s, t)) return {};
  const Vec2 p[3] = {s.knots[t[0]], s.knots[t[1]], s.knots[t[2]]};
  const double area = signed_area(p[0], p[1], p[2]);
  Jet sum;
  if (s.count == 3) {
    if (contains(p[0], p[1], p[2], u, direction)) sum.value = 1 / std::abs(area);
    return sum;
  }
  const double degree = static_cast<double>(s.count) - 3;
  for (std::size_t j = 0; j < 3; ++j) {
    const Vec2 a = p[(j + 1) % 3];
    const Vec2 b = p[(j + 2) % 3];
    const double lambda = signed_area(u, a, b) / area;
    const Vec2 g{(a.y - b.y) / (2 * area), (b.x - a.x) / (2 * area)};
    const Jet m = evaluate(s.without(t[j]), u, direction);
    sum.value += lambda * m.value;
    // grad M = k sum grad(lambda_j) M(V \ t_j), and the same once more for the Hessian.
    sum.dx += degree * g.x * m.value;
    sum.dy += degree * g.y * m.value;
    sum.dxx += degree * g.x * m.dx;
    sum.dxy += degree * g.x * m.dy;
    sum.dyy += degree * g.y * m.dy;
  }
  return sum;
}

}  // namespace

Vec2 inward_direction(Vec2 u, double width, double height) {
  constexpr Vec2 kGeneric{0.8191520442889918, 0.5735764363510462};
  return {u.x >= width ? -kGeneric.x : kGeneric.x, u.y >= height ? -kGeneric.y : kGeneric.y};
}

ReferenceBasis::ReferenceBasis(const SplineSpace& space)
    : space_(space), triangles_(function_triangles(space)) {
  const Vec2 margin{2 * kOnLine, 2 * kOnLine};
  for (FunctionIndex f = 0; f < space.function_count(); ++f) {
    Vec2 low = space.position(space.functions()[f].knots[0]);
    Vec2 high = low;
    const auto include = [&](CornerIndex c) {
      const Vec2 p = space.position(c);
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    };
    for (int i = 0; i < space.degree(); ++i) include(space.functions()[f].knots[static_cast<std::size_t>(i)]);
    for (const auto& t : triangles_[f]) std::for_each(t.begin(), t.end(), include);
    boxes_.emplace_back(low - margin, high + margin);
  }
}

Jet ReferenceBasis::evaluate(FunctionIndex f, Vec2 u, Vec2 direction) const {
  Jet sum;
  const auto& [low, high] = boxes_[f];
  if (u.x < low.x || u.y < low.y || u.x > high.x || u.y > high.y) return sum;
  Simplex s{};
  s.count = 3 + static_cast<std::size_t>(space_.degree());
  for (int i = 0; i < space_.degree(); ++i) {
    const auto place = static_cast<std::size_t>(i);
    s.knots[3 + place] = space_.position(space_.functions()[f].knots[place]);
  }
  for (const auto& t : triangles_[f]) {
    for (std::size_t i = 0; i < 3; ++i) s.knots[i] = space_.position(t[i]);
    const double area = signed_area(s.knots[0], s.knots[1], s.knots[2]);
    const Jet m = spline::evaluate(s, u, direction);
    sum.value += area * m.value;
    sum.dx += area * m.dx;
    sum.dy += area * m.dy;
    sum.dxx += area * m.dxx;
    sum.dxy += area * m.dxy;
    sum.dyy += area * m.dyy;
  }
  return sum;
}

std::vector<Jet> ReferenceBasis::evaluate_all(Vec2 u) const {
  const Vec2 direction = inward_direction(u, space_.mesh().width, space_.mesh().height);
  std::vector<Jet> result(space_.function_count());
  for (FunctionIndex f = 0; f < result.size(); ++f) result[f] = evaluate(f, u, direction);
  return result;
}

}  // namespace knotreel::spline
