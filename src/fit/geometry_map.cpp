// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/geometry_map.h"

#include <algorithm>
#include <array>

#include "knotreel/spline/surface.h"

namespace knotreel::fit {

namespace {

constexpr DampedNewtonOptions kSearch{.tolerance = 1e-5, .max_steps = 12, .shortest = 1.0 / 64};
constexpr double kNearEnough = 3e-3;  // pixels; not worth another start
// From a place on the wrong side of a feature there may be no way; one of these is on the other.
constexpr std::array<Vec2, 9> kOtherStarts{
    {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};

}  // namespace

std::vector<double> displacement_control(const spline::SplineSpace& space,
                                         std::span<const Vec2> displacement) {
  std::vector<double> control;
  control.reserve(2 * space.function_count());
  for (const std::uint32_t g : space.geometry_of()) {
    control.push_back(displacement[g].x);
    control.push_back(displacement[g].y);
  }
  return control;
}

GeometryMap::GeometryMap(const spline::Basis& basis, std::span<const Vec2> displacement)
    : basis_(basis), control_(displacement_control(basis.space(), displacement)) {}

Vec2 GeometryMap::clamped(Vec2 u) const {
  const auto& mesh = basis_.space().mesh();
  return {std::clamp(u.x, 0.0, mesh.width), std::clamp(u.y, 0.0, mesh.height)};
}

MapValue GeometryMap::at(Vec2 u) const {
  const auto& mesh = basis_.space().mesh();
  std::array<spline::Jet, 2> d;
  spline::surface_jets(basis_, {control_, 2}, u, spline::inward_direction(u, mesh.width, mesh.height), d);
  return {u + Vec2{d[0].value, d[1].value}, {1 + d[0].dx, d[1].dx}, {d[0].dy, 1 + d[1].dy}};
}

Vec2 GeometryMap::place_of(Vec2 target, Vec2 start) const {
  const auto search = [&](Vec2 from) {
    return damped_newton(
        target, from, kSearch, [&](Vec2 u) { return at(u); }, [this](Vec2 u) { return clamped(u); });
  };
  Attempt best = search(start);
  for (std::size_t i = 0; i < kOtherStarts.size() && best.miss > kNearEnough; ++i) {
    const Attempt other = search(target + kOtherStarts[i]);
    if (other.miss < best.miss) best = other;
  }
  return best.place;
}

}  // namespace knotreel::fit
