// SPDX-License-Identifier: GPL-3.0-or-later
#include "spline/link_polygons.h"

#include <algorithm>

namespace knotreel::spline {

namespace {

/// The same for both directions of an edge.
std::uint64_t undirected(const DirectedEdge& e) {
  return (std::uint64_t{std::min(e[0], e[1])} << 32) | std::max(e[0], e[1]);
}

/// Corners where more chains start than end (balance > 0) or the other way round, with repetition, ascending.
void open_ends(const std::vector<DirectedEdge>& edges, std::vector<CornerIndex>& starts,
               std::vector<CornerIndex>& ends) {
  for (const DirectedEdge& e : edges) {
    starts.push_back(e[0]);
    ends.push_back(e[1]);
  }
  std::sort(starts.begin(), starts.end());
  std::sort(ends.begin(), ends.end());
  std::vector<CornerIndex> only_starts;
  std::vector<CornerIndex> only_ends;
  std::set_difference(starts.begin(), starts.end(), ends.begin(), ends.end(),
                      std::back_inserter(only_starts));
  std::set_difference(ends.begin(), ends.end(), starts.begin(), starts.end(), std::back_inserter(only_ends));
  starts = std::move(only_starts);
  ends = std::move(only_ends);
}

/// The multiple corner of J through which open chains are closed, or kNone if the edges touch it already.
constexpr CornerIndex kNone = 0xffffffffu;
CornerIndex closing_corner(const mesh::CutMesh& cut, std::span<const CornerIndex> vertex,
                           const std::vector<DirectedEdge>& edges) {
  for (const CornerIndex c : vertex) {
    if (!cut.corners[c].multiple) continue;
    const bool touched = std::any_of(edges.begin(), edges.end(),
                                     [c](const DirectedEdge& e) { return e[0] == c || e[1] == c; });
    if (!touched) return c;
  }
  return kNone;
}

void close_chains(const mesh::CutMesh& cut, std::span<const CornerIndex> vertex,
                  std::vector<DirectedEdge>& edges) {
  std::vector<CornerIndex> starts;
  std::vector<CornerIndex> ends;
  open_ends(edges, starts, ends);
  if (starts.empty()) return;
  const CornerIndex through = closing_corner(cut, vertex, edges);
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (through == kNone) {
      edges.push_back({ends[i], starts[i]});
    } else {
      edges.push_back({ends[i], through});
      edges.push_back({through, starts[i]});
    }
  }
}

}  // namespace

void cancel_opposite(std::vector<DirectedEdge>& edges) {
  std::sort(edges.begin(), edges.end(),
            [](const DirectedEdge& a, const DirectedEdge& b) { return undirected(a) < undirected(b); });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < edges.size();) {
    const CornerIndex lo = std::min(edges[i][0], edges[i][1]);
    const CornerIndex hi = std::max(edges[i][0], edges[i][1]);
    std::size_t end = i;
    std::ptrdiff_t up = 0;
    for (; end < edges.size() && undirected(edges[end]) == undirected({lo, hi}); ++end) {
      up += edges[end][0] == lo ? 1 : -1;
    }
    for (; up > 0; --up) edges[kept++] = {lo, hi};
    for (; up < 0; ++up) edges[kept++] = {hi, lo};
    i = end;
  }
  edges.resize(kept);
}

Loops link_loops(const mesh::CutMesh& cut, std::span<const CornerIndex> vertex,
                 std::vector<DirectedEdge>& edges, std::vector<std::uint32_t>& place) {
  close_chains(cut, vertex, edges);
  std::sort(edges.begin(), edges.end());

  // Walk the balanced edges; a corner met again on the path cuts off a loop.
  Loops loops;
  std::vector<bool> used(edges.size(), false);
  std::vector<CornerIndex> path;
  std::size_t first_unused = 0;
  const auto append = [&](CornerIndex c) {
    place[c] = static_cast<std::uint32_t>(path.size());
    path.push_back(c);
  };
  while (true) {
    if (path.empty()) {
      while (first_unused < edges.size() && used[first_unused]) ++first_unused;
      if (first_unused == edges.size()) break;
      append(edges[first_unused][0]);
    }
    auto it = std::lower_bound(edges.begin(), edges.end(), DirectedEdge{path.back(), 0});
    while (used[static_cast<std::size_t>(it - edges.begin())]) ++it;
    used[static_cast<std::size_t>(it - edges.begin())] = true;
    const CornerIndex next = (*it)[1];
    if (place[next] == kNotOnPath) {
      append(next);
      continue;
    }
    const auto met = path.begin() + place[next];
    std::vector<CornerIndex> loop(met, path.end());
    for (const CornerIndex c : loop) place[c] = kNotOnPath;
    path.erase(met, path.end());
    if (!path.empty()) append(next);
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    if (loop.size() >= 3) loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace knotreel::spline
