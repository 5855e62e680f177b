// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/carried_geometry.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace knotreel::track {

namespace {

using Name = std::array<std::uint32_t, 3>;

/// Ids of the knots of each geometry group, ascending; unused places hold the largest number.
std::vector<Name> group_names(const spline::SplineSpace& space) {
  std::vector<Name> names(space.geometry_count());
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    Name& name = names[space.geometry_of()[f]];
    for (std::size_t i = 0; i < 3; ++i) {
      const mesh::CornerIndex c = space.functions()[f].knots[i];
      name[i] = c == spline::kNoCorner
                    ? 0xffffffffU
                    : static_cast<std::uint32_t>(space.mesh().knots[space.cut().corners[c].knot].id);
    }
    std::sort(name.begin(), name.end());
  }
  return names;
}

struct Mean {
  Vec2 sum;
  double count = 0;
};

}  // namespace

std::vector<Vec2> carried_displacement(const spline::SplineSpace& from, std::span<const Vec2> displacement,
                                       const spline::SplineSpace& to) {
  std::vector<Vec2> result(to.geometry_count());
  if (std::all_of(displacement.begin(), displacement.end(), [](Vec2 d) { return d == Vec2{}; }))
    return result;
  std::vector<std::pair<Name, Vec2>> known;
  std::unordered_map<std::uint32_t, Mean> by_knot;
  const std::vector<Name> old_names = group_names(from);
  known.reserve(old_names.size());
  by_knot.reserve(from.mesh().knots.size());
  for (std::size_t g = 0; g < old_names.size(); ++g) {
    known.emplace_back(old_names[g], displacement[g]);
    for (const std::uint32_t id : old_names[g]) {
      Mean& mean = by_knot[id];
      mean.sum = mean.sum + displacement[g];
      mean.count += 1;
    }
  }
  std::sort(known.begin(), known.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const std::vector<Vec2> sites = to.geometry_greville();
  const std::vector<Name> names = group_names(to);
  for (std::size_t g = 0; g < names.size(); ++g) {
    if (mesh::on_side(to.mesh(), sites[g])) continue;  // stays exactly there
    const auto same = std::lower_bound(known.begin(), known.end(), names[g],
                                       [](const auto& k, const Name& name) { return k.first < name; });
    if (same != known.end() && same->first == names[g]) {
      result[g] = same->second;
      continue;
    }
    Mean mean;
    for (const std::uint32_t id : names[g]) {
      const auto it = id == 0xffffffffU ? by_knot.end() : by_knot.find(id);
      if (it == by_knot.end()) continue;
      mean.sum = mean.sum + (1 / it->second.count) * it->second.sum;
      mean.count += 1;
    }
    if (mean.count > 0) result[g] = (1 / mean.count) * mean.sum;
  }
  return result;
}

}  // namespace knotreel::track
