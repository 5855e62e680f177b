#include "document/identity.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace knotreel::document {

using mesh::CornerIndex;

namespace {

/// Pairs equal names of two lists; of several equal names in one list, the first counts.
template <class Name>
std::vector<std::uint32_t> match_names(const std::vector<Name>& names, const std::vector<Name>& before) {
  std::vector<std::uint32_t> order(before.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t x, std::uint32_t y) {
    return before[x] != before[y] ? before[x] < before[y] : x < y;
  });
  std::vector<std::uint32_t> matches(names.size(), kNoMatch);
  std::vector<bool> taken(before.size(), false);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto it = std::lower_bound(order.begin(), order.end(), names[i],
                                     [&](std::uint32_t x, const Name& name) { return before[x] < name; });
    if (it == order.end() || before[*it] != names[i] || taken[*it]) continue;
    taken[*it] = true;
    matches[i] = *it;
  }
  return matches;
}

/// Name of a corner among those of its knot: the line along the first edge of its fan, as 1 for a side of the
/// domain, or 2 + id of the end of the feature segment towards which that edge runs; 0 without a line.
std::uint64_t sector_name(const mesh::KnotMesh& mesh, const mesh::CutMesh& cut, CornerIndex c,
                          const std::vector<std::uint32_t>& place_on_segment) {
  const mesh::Corner& corner = cut.corners[c];
  if (corner.closed) return 0;
  if (corner.first_line >= mesh.segments.size()) return 1;
  const auto& knots = mesh.segments[corner.first_line].knots;
  const KnotIndex next = cut.corners[cut.fan(c).front()].knot;
  const bool forward = corner.knot == knots.front() || next == knots.back() ||
                       (corner.knot != knots.back() && next != knots.front() &&
                        place_on_segment[next] > place_on_segment[corner.knot]);
  const KnotIndex end = forward ? knots.back() : knots.front();
  return 2 + static_cast<std::uint64_t>(mesh.knots[end].id);
}

using CornerName = std::pair<std::uint32_t, std::uint64_t>;
using FunctionName = std::array<CornerName, spline::kMaxDegree>;

std::vector<CornerName> corner_names(const mesh::KnotMesh& mesh, const mesh::CutMesh& cut) {
  std::vector<std::uint32_t> place(mesh.knots.size(), 0);
  for (const mesh::FeatureSegment& s : mesh.segments) {
    for (std::uint32_t i = 1; i + 1 < s.knots.size(); ++i) place[s.knots[i]] = i;
  }
  std::vector<CornerName> corners;
  for (CornerIndex c = 0; c < cut.corners.size(); ++c) {
    corners.emplace_back(static_cast<std::uint32_t>(mesh.knots[cut.corners[c].knot].id),
                         sector_name(mesh, cut, c, place));
  }
  return corners;
}

std::vector<FunctionName> function_names(const spline::SplineSpace& space) {
  const std::vector<CornerName> corners = corner_names(space.mesh(), space.cut());
  std::vector<FunctionName> names;
  names.reserve(space.function_count());
  for (const spline::Function& f : space.functions()) {
    FunctionName name;
    name.fill({kNoMatch, 0});  // unused places stay behind the others
    for (std::size_t i = 0; i < static_cast<std::size_t>(space.degree()); ++i) name[i] = corners[f.knots[i]];
    std::sort(name.begin(), name.end());
    names.push_back(name);
  }
  return names;
}

using GroupName = std::array<std::uint32_t, spline::kMaxDegree>;

std::vector<GroupName> group_names(const spline::SplineSpace& space) {
  std::vector<GroupName> names(space.geometry_count());
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    GroupName name;
    name.fill(kNoMatch);  // unused places stay behind the others
    for (std::size_t i = 0; i < static_cast<std::size_t>(space.degree()); ++i) {
      const KnotIndex k = space.cut().corners[space.functions()[f].knots[i]].knot;
      name[i] = static_cast<std::uint32_t>(space.mesh().knots[k].id);
    }
    std::sort(name.begin(), name.end());
    names[space.geometry_of()[f]] = name;
  }
  return names;
}

std::vector<std::uint32_t> iota(std::size_t count) {
  std::vector<std::uint32_t> indices(count);
  std::iota(indices.begin(), indices.end(), 0u);
  return indices;
}

}  // namespace

Matches identity(const FrameState& state) {
  return {iota(state.mesh().knots.size()), iota(state.space->function_count()),
          iota(state.space->geometry_count())};
}

std::vector<std::uint32_t> match_knots(const mesh::KnotMesh& mesh, const mesh::KnotMesh& before) {
  const auto ids = [](const mesh::KnotMesh& m) {
    std::vector<std::uint32_t> result;
    for (const mesh::Knot& k : m.knots) result.push_back(static_cast<std::uint32_t>(k.id));
    return result;
  };
  return match_names(ids(mesh), ids(before));
}

std::vector<std::uint32_t> match_corners(const mesh::KnotMesh& mesh, const mesh::CutMesh& cut,
                                         const mesh::KnotMesh& mesh_before, const mesh::CutMesh& cut_before) {
  return match_names(corner_names(mesh, cut), corner_names(mesh_before, cut_before));
}

std::vector<std::uint32_t> match_functions(const spline::SplineSpace& space,
                                           const spline::SplineSpace& before) {
  return match_names(function_names(space), function_names(before));
}

std::vector<std::uint32_t> match_groups(const spline::SplineSpace& space, const spline::SplineSpace& before) {
  return match_names(group_names(space), group_names(before));
}

}  // namespace knotreel::document
