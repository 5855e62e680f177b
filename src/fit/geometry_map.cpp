#include "fit/geometry_map.h"

#include <algorithm>
#include <array>

namespace knotreel::fit {

namespace {

constexpr double kTolerance = 1e-5;  // pixels
constexpr int kMaxSteps = 12;
constexpr double kShortest = 1.0 / 64;  // share of a step
constexpr double kNear = 3e-3;          // pixels; not worth another start
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

GeometryMap::Value GeometryMap::at(Vec2 u, std::vector<spline::BasisJet>& jets) const {
  const auto& mesh = basis_.space().mesh();
  basis_.evaluate(u, spline::inward_direction(u, mesh.width, mesh.height), jets);
  Value v;
  for (const spline::BasisJet& j : jets) {
    const Vec2 d = by_function_[j.function];
    v.offset = v.offset + j.jet.value * d;
    v.by_x = v.by_x + j.jet.dx * d;
    v.by_y = v.by_y + j.jet.dy * d;
  }
  return v;
}

GeometryMap::Attempt GeometryMap::descend(Vec2 target, Vec2 start,
                                          std::vector<spline::BasisJet>& jets) const {
  Vec2 u = clamped(start);
  Value v = at(u, jets);
  Attempt best{u, norm(target - u - v.offset)};
  for (int step = 0; step < kMaxSteps && best.miss > kTolerance; ++step) {
    const Vec2 miss = target - u - v.offset;
    const Vec2 ex = Vec2{1, 0} + v.by_x;
    const Vec2 ey = Vec2{0, 1} + v.by_y;
    const double det = cross(ex, ey);
    const Vec2 move = det > 0.05 ? Vec2{cross(miss, ey) / det, cross(ex, miss) / det} : miss;
    // Half the way, and half of that, until it gets better: the map may have a kink in between.
    bool is_better = false;
    for (double t = 1; t > kShortest && !is_better; t *= 0.5) {
      const Vec2 next = clamped(u + t * move);
      const Value value = at(next, jets);
      const double length = norm(target - next - value.offset);
      if (length >= best.miss) continue;
      u = next;
      v = value;
      best = {u, length};
      is_better = true;
    }
    if (!is_better) break;
  }
  return best;
}

Vec2 GeometryMap::place_of(Vec2 target, Vec2 start, std::vector<spline::BasisJet>& jets) const {
  Attempt best = descend(target, start, jets);
  for (std::size_t i = 0; i < kOtherStarts.size() && best.miss > kNear; ++i) {
    const Attempt other = descend(target, target + kOtherStarts[i], jets);
    if (other.miss < best.miss) best = other;
  }
  return best.place;
}

}  // namespace knotreel::fit
