// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/joints.h"

#include <algorithm>
#include <cstddef>
#include <optional>

namespace knotreel::fit {

namespace {

using mesh::KnotIndex;

constexpr double kNear = 0.5;  // pixels
constexpr std::uint32_t kUnknown = 0xffffffff;

/// A knot where segments end.
struct Joint {
  KnotIndex knot = 0;
  std::size_t segments = 0;
  std::array<KnotIndex, 2> next{};  ///< along two of them
  std::uint32_t group = kUnknown;   ///< of geometry, of the knot
  std::array<std::uint32_t, 2> next_group{kUnknown, kUnknown};

  bool is_whole() const {
    return segments == 2 && group != kUnknown && next_group[0] != kUnknown && next_group[1] != kUnknown;
  }
};

/// All ends of segments, by knot.
class Joints {
 public:
  explicit Joints(const spline::SplineSpace& space) : joint_of_(space.mesh().knots.size(), kUnknown) {
    for (const mesh::FeatureSegment& s : space.mesh().segments) {
      add(s.knots.front(), s.knots[1]);
      add(s.knots.back(), s.knots[s.knots.size() - 2]);
    }
    for (std::size_t f = 0; f < space.function_count(); ++f) find_group(space, f);
  }

  const std::vector<Joint>& all() const { return all_; }

 private:
  void add(KnotIndex knot, KnotIndex next) {
    if (joint_of_[knot] == kUnknown) {
      joint_of_[knot] = static_cast<std::uint32_t>(all_.size());
      all_.push_back({.knot = knot});
    }
    Joint& joint = all_[joint_of_[knot]];
    if (joint.segments < 2) joint.next[joint.segments] = next;
    ++joint.segments;
  }

  /// Of a function with all knots at a joint, or all but one, which is the next one along a segment.
  void find_group(const spline::SplineSpace& space, std::size_t f) {
    std::array<KnotIndex, 3> knots{};
    const auto degree = static_cast<std::size_t>(space.degree());
    for (std::size_t i = 0; i < degree; ++i)
      knots[i] = space.cut().corners[space.functions()[f].knots[i]].knot;
    for (std::size_t i = 0; i < degree; ++i) {
      if (joint_of_[knots[i]] == kUnknown) continue;
      Joint& joint = all_[joint_of_[knots[i]]];
      const auto others = [&](KnotIndex k) { return k != joint.knot; };
      const auto end = knots.begin() + static_cast<std::ptrdiff_t>(degree);
      const auto other = std::find_if(knots.begin(), end, others);
      if (other == end) {
        joint.group = space.geometry_of()[f];
      } else if (std::count_if(knots.begin(), end, others) == 1) {
        for (std::size_t n = 0; n < std::min<std::size_t>(joint.segments, 2); ++n) {
          if (joint.next[n] == *other) joint.next_group[n] = space.geometry_of()[f];
        }
      }
    }
  }

  std::vector<std::uint32_t> joint_of_;  ///< by knot
  std::vector<Joint> all_;
};

/// Finds the nearest of some joints.
class Nearest {
 public:
  Nearest(const mesh::KnotMesh& mesh, const std::vector<Joint>& joints) : mesh_(mesh) {
    for (const Joint& j : joints) by_x_.push_back(&j);
    std::sort(by_x_.begin(), by_x_.end(), [&](const Joint* a, const Joint* b) {
      return position(a).x != position(b).x ? position(a).x < position(b).x : a->knot < b->knot;
    });
  }

  const Joint* within(Vec2 p, double distance) const {
    const Joint* nearest = nullptr;
    auto it = std::lower_bound(by_x_.begin(), by_x_.end(), p.x - distance,
                               [&](const Joint* j, double x) { return position(j).x < x; });
    for (; it != by_x_.end() && position(*it).x <= p.x + distance; ++it) {
      const double d = norm(position(*it) - p);
      if (d < distance) nearest = *it, distance = d;
    }
    return nearest;
  }

 private:
  Vec2 position(const Joint* joint) const { return mesh_.knots[joint->knot].position; }

  const mesh::KnotMesh& mesh_;
  std::vector<const Joint*> by_x_;
};

std::optional<JointEquation> equation_of(const Joint& joint, const std::vector<Vec2>& sites) {
  if (!joint.is_whole()) return std::nullopt;
  const auto& [one, other] = joint.next_group;
  const double to_one = norm(sites[one] - sites[joint.group]);
  const double to_other = norm(sites[other] - sites[joint.group]);
  if (to_one <= 0 || to_other <= 0) return std::nullopt;
  const double share = to_other / (to_one + to_other);
  return JointEquation{{{{joint.group, 1}, {one, -share}, {other, share - 1}}},
                       share * sites[one] + (1 - share) * sites[other] - sites[joint.group]};
}

}  // namespace

std::vector<Vec2> joints_of(std::span<const CurvePoint> points) {
  std::vector<Vec2> joints;
  for (const CurvePoint& p : points) {
    if (p.joint) joints.push_back(p.parameter);
  }
  return joints;
}

std::vector<JointEquation> joint_equations(const spline::SplineSpace& space, std::span<const Vec2> joints) {
  std::vector<JointEquation> equations;
  if (joints.empty() || space.degree() < 2) return equations;
  const Joints ends(space);
  const Nearest nearest(space.mesh(), ends.all());
  const std::vector<Vec2> sites = space.geometry_greville();
  for (const Vec2 p : joints) {
    const Joint* const joint = nearest.within(p, kNear);
    if (!joint) continue;
    if (const auto equation = equation_of(*joint, sites)) equations.push_back(*equation);
  }
  return equations;
}

}  // namespace knotreel::fit
