#include "fit/geometry_map.h"

#include <algorithm>
#include <array>

namespace knotreel::fit {

namespace {

constexpr DampedNewtonOptions kSearch{.tolerance = 1e-5, .max_steps = 12, .shortest = 1.0 / 64};
constexpr double kNear = 3e-3;  // pixels; not worth another start
// From a place on the wrong side of a feature there may be no way; one of these is on the other.
constexpr std::array<Vec2, 9> kOtherStarts{
    {{0, 0}, {1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}}};

}  // namespace

GeometryMap::GeometryMap(const spline::Basis& basis, std::span<const Vec2> displacement) : basis_(basis) {
  const auto& space = basis.space();
  by_function_.resize(space.function_count());
  for (std::size_t f = 0; f < by_function_.size(); ++f)
    by_function_[f] = displacement[space.geometry_of()[f]];
}

Vec2 GeometryMap::clamped(Vec2 u) const {
  const auto& mesh = basis_.space().mesh();
  return {std::clamp(u.x, 0.0, mesh.width), std::clamp(u.y, 0.0, mesh.height)};
}

MapValue GeometryMap::at(Vec2 u, std::vector<spline::BasisJet>& jets) const {
  const auto& mesh = basis_.space().mesh();
  basis_.evaluate(u, spline::inward_direction(u, mesh.width, mesh.height), jets);
  MapValue v{u, {1, 0}, {0, 1}};
  for (const spline::BasisJet& j : jets) {
    const Vec2 d = by_function_[j.function];
    v.at = v.at + j.jet.value * d;
    v.by_x = v.by_x + j.jet.dx * d;
    v.by_y = v.by_y + j.jet.dy * d;
  }
  return v;
}

Vec2 GeometryMap::place_of(Vec2 target, Vec2 start, std::vector<spline::BasisJet>& jets) const {
  const auto search = [&](Vec2 from) {
    return damped_newton(
        target, from, kSearch, [&](Vec2 u) { return at(u, jets); }, [this](Vec2 u) { return clamped(u); });
  };
  Attempt best = search(start);
  for (std::size_t i = 0; i < kOtherStarts.size() && best.miss > kNear; ++i) {
    const Attempt other = search(target + kOtherStarts[i]);
    if (other.miss < best.miss) best = other;
  }
  return best.place;
}

}  // namespace knotreel::fit
