// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/identity.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace knotreel::document {

using mesh::CornerIndex;

namespace {

/// The names of a list in order, each with its place in the list; equal ones by place.
template <class Name>
class SortedNames {
 public:
  explicit SortedNames(const std::vector<Name>& names) {
    entries_.reserve(names.size());
    for (std::uint32_t i = 0; i < names.size(); ++i) entries_.emplace_back(names[i], i);
    // Those of functions and groups nearly always are in order.
    if (!std::is_sorted(entries_.begin(), entries_.end())) std::sort(entries_.begin(), entries_.end());
  }

  /// Place of the first of equal names, or kNoMatch.
  std::uint32_t find(const Name& name) const {
    const auto it = std::lower_bound(entries_.begin(), entries_.end(), name,
                                     [](const Entry& e, const Name& n) { return e.first < n; });
    return it != entries_.end() && !(name < it->first) ? it->second : kNoMatch;
  }

 private:
  using Entry = std::pair<Name, std::uint32_t>;
  std::vector<Entry> entries_;
};

/// Pairs equal names of two lists; of several equal names in one list, the first counts.
template <class Name>
std::vector<std::uint32_t> match_names(const std::vector<Name>& names, const std::vector<Name>& before) {
  const SortedNames sorted(before);
  std::vector<std::uint32_t> matches(names.size(), kNoMatch);
  std::vector<bool> taken(before.size(), false);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::uint32_t match = sorted.find(names[i]);
    if (match == kNoMatch || taken[match]) continue;
    taken[match] = true;
    matches[i] = match;
  }
  return matches;
}

/// Short names for long ones: elements of either list have equal numbers where their names are equal, those
/// without an equal in the list before have kNoMatch.
struct ShortNames {
  std::vector<std::uint32_t> now;
  std::vector<std::uint32_t> before;
};

template <class Name>
ShortNames short_names(const std::vector<Name>& now, const std::vector<Name>& before) {
  const SortedNames sorted(before);
  ShortNames result;
  for (const auto& [names, numbers] : {std::pair(&now, &result.now), std::pair(&before, &result.before)}) {
    numbers->reserve(names->size());
    for (const Name& name : *names) numbers->push_back(sorted.find(name));
  }
  return result;
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
std::vector<CornerName> corner_names(const mesh::KnotMesh& mesh, const mesh::CutMesh& cut) {
  std::vector<std::uint32_t> place(mesh.knots.size(), 0);
  for (const mesh::FeatureSegment& s : mesh.segments) {
    for (std::uint32_t i = 1; i + 1 < s.knots.size(); ++i) place[s.knots[i]] = i;
  }
  std::vector<CornerName> corners;
  corners.reserve(cut.corners.size());
  for (CornerIndex c = 0; c < cut.corners.size(); ++c) {
    corners.emplace_back(static_cast<std::uint32_t>(mesh.knots[cut.corners[c].knot].id),
                         sector_name(mesh, cut, c, place));
  }
  return corners;
}

/// The names of the corners or knots of a function, ascending.
using FunctionName = std::array<std::uint32_t, spline::kMaxDegree>;

/// @param name of a corner.
template <class NameOf>
FunctionName function_name(const spline::SplineSpace& space, spline::FunctionIndex f, const NameOf& name_of) {
  FunctionName name;
  name.fill(kNoMatch);  // unused places stay behind the others
  for (std::size_t i = 0; i < static_cast<std::size_t>(space.degree()); ++i) {
    name[i] = name_of(space.functions()[f].knots[i]);
  }
  std::sort(name.begin(), name.end());
  return name;
}

std::vector<FunctionName> function_names(const spline::SplineSpace& space,
                                         const std::vector<std::uint32_t>& of_corners) {
  std::vector<FunctionName> names;
  names.reserve(space.function_count());
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    names.push_back(function_name(space, f, [&](CornerIndex c) { return of_corners[c]; }));
  }
  return names;
}

std::vector<FunctionName> group_names(const spline::SplineSpace& space,
                                      const std::vector<std::uint32_t>& of_knots) {
  std::vector<FunctionName> names(space.geometry_count());
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    names[space.geometry_of()[f]] =
        function_name(space, f, [&](CornerIndex c) { return of_knots[space.cut().corners[c].knot]; });
  }
  return names;
}

std::vector<std::uint32_t> knot_names(const mesh::KnotMesh& mesh) {
  std::vector<std::uint32_t> names;
  names.reserve(mesh.knots.size());
  for (const mesh::Knot& k : mesh.knots) names.push_back(static_cast<std::uint32_t>(k.id));
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
  return match_names(knot_names(mesh), knot_names(before));
}

std::vector<std::uint32_t> match_corners(const mesh::KnotMesh& mesh, const mesh::CutMesh& cut,
                                         const mesh::KnotMesh& mesh_before, const mesh::CutMesh& cut_before) {
  return match_names(corner_names(mesh, cut), corner_names(mesh_before, cut_before));
}

std::vector<std::uint32_t> match_functions(const spline::SplineSpace& space,
                                           const spline::SplineSpace& before) {
  const ShortNames corners =
      short_names(corner_names(space.mesh(), space.cut()), corner_names(before.mesh(), before.cut()));
  return match_names(function_names(space, corners.now), function_names(before, corners.before));
}

std::vector<std::uint32_t> match_groups(const spline::SplineSpace& space, const spline::SplineSpace& before,
                                        const std::vector<std::uint32_t>& knots) {
  return match_names(group_names(space, knots), group_names(before, iota(before.mesh().knots.size())));
}

}  // namespace knotreel::document
