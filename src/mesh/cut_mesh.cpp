// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/cut_mesh.h"

#include <algorithm>

#include "knotreel/base/error.h"
#include "mesh/half_edges.h"

namespace knotreel::mesh {

namespace {

/// Walks around knots of one mesh, with the feature edges as walls.
class SectorWalk {
 public:
  /// @param order as from sorted_half_edges().
  SectorWalk(const KnotMesh& mesh, HalfEdges half_edges, const std::vector<std::uint32_t>& order)
      : mesh_(mesh), half_edges_(std::move(half_edges)) {
    line_.assign(half_edges_.opposite.size(), kNoLine);
    mark_segments(order);
    mark_sides();
  }

  /// Half edge with the same origin in the next face in positive order, or none at a wall or the border.
  std::uint32_t next_around(std::uint32_t h) const {
    const std::uint32_t edge = HalfEdges::previous(h);
    return line_[edge] != kNoLine ? kNoHalfEdge : half_edges_.opposite[edge];
  }

  std::uint32_t previous_around(std::uint32_t h) const {
    if (line_[h] != kNoLine) return kNoHalfEdge;
    return HalfEdges::next(half_edges_.opposite[h]);
  }

  std::uint32_t line(std::uint32_t h) const { return line_[h]; }

 private:
  void mark_segments(const std::vector<std::uint32_t>& order) {
    const auto less = [&](std::uint32_t h, std::pair<KnotIndex, KnotIndex> key) {
      return std::minmax({origin(mesh_.faces, h), target(mesh_.faces, h)}) < key;
    };
    for (std::uint32_t s = 0; s < mesh_.segments.size(); ++s) {
      const auto& knots = mesh_.segments[s].knots;
      for (std::size_t i = 1; i < knots.size(); ++i) {
        const std::pair<KnotIndex, KnotIndex> key = std::minmax({knots[i - 1], knots[i]});
        const std::uint32_t h = *std::lower_bound(order.begin(), order.end(), key, less);
        line_[h] = s;
        line_[half_edges_.opposite[h]] = s;
      }
    }
  }

  void mark_sides() {
    const auto sides = static_cast<std::uint32_t>(mesh_.segments.size());
    for (std::uint32_t h = 0; h < half_edges_.opposite.size(); ++h) {
      if (half_edges_.opposite[h] != kNoHalfEdge) continue;
      const Vec2 a = mesh_.knots[origin(mesh_.faces, h)].position;
      const Vec2 b = mesh_.knots[target(mesh_.faces, h)].position;
      line_[h] = sides + (a.y == 0 && b.y == 0                         ? 0
                          : a.x == mesh_.width && b.x == mesh_.width   ? 1
                          : a.y == mesh_.height && b.y == mesh_.height ? 2
                                                                       : 3);
    }
  }

  const KnotMesh& mesh_;
  HalfEdges half_edges_;
  std::vector<std::uint32_t> line_;
};

std::vector<Line> cut_lines(const KnotMesh& mesh) {
  std::vector<Line> lines;
  for (const FeatureSegment& s : mesh.segments) {
    lines.push_back({mesh.knots[s.knots.front()].position, mesh.knots[s.knots.back()].position});
  }
  const Vec2 tl{0, 0};
  const Vec2 tr{mesh.width, 0};
  const Vec2 br{mesh.width, mesh.height};
  const Vec2 bl{0, mesh.height};
  lines.insert(lines.end(), {{tl, tr}, {tr, br}, {br, bl}, {bl, tl}});
  return lines;
}

}  // namespace

CutMesh cut_open(const KnotMesh& mesh) {
  const std::vector<std::uint32_t> order = sorted_half_edges(mesh.faces);
  auto half_edges = connect_half_edges(mesh.faces, order);
  if (!half_edges) throw Error(ErrorKind::kInvalidArgument, "cannot cut the mesh: its faces do not join");
  const SectorWalk walk(mesh, std::move(*half_edges), order);
  const std::size_t half_edge_count = 3 * mesh.faces.size();

  // Half edges by origin, in face order.
  std::vector<std::uint32_t> begin(mesh.knots.size() + 1, 0);
  for (std::uint32_t h = 0; h < half_edge_count; ++h) ++begin[origin(mesh.faces, h) + 1];
  for (std::size_t k = 0; k < mesh.knots.size(); ++k) begin[k + 1] += begin[k];
  std::vector<std::uint32_t> around(half_edge_count);
  {
    std::vector<std::uint32_t> cursor(begin.begin(), begin.end() - 1);
    for (std::uint32_t h = 0; h < half_edge_count; ++h) around[cursor[origin(mesh.faces, h)]++] = h;
  }

  CutMesh cut;
  cut.lines = cut_lines(mesh);
  constexpr CornerIndex kUnset = 0xffffffffu;
  std::vector<CornerIndex> corner_of(half_edge_count, kUnset);
  std::vector<std::uint32_t> first_half_edge;
  for (KnotIndex k = 0; k < mesh.knots.size(); ++k) {
    for (std::uint32_t i = begin[k]; i < begin[k + 1]; ++i) {
      if (corner_of[around[i]] != kUnset) continue;
      const auto index = static_cast<CornerIndex>(cut.corners.size());
      Corner corner;
      corner.knot = k;
      corner.multiple = mesh.knots[k].kind == KnotKind::kVertex;
      std::uint32_t start = around[i];
      for (std::uint32_t h = start;;) {
        const std::uint32_t before = walk.previous_around(h);
        if (before == kNoHalfEdge) {
          start = h;
          break;
        }
        h = before;
        if (h == start) {
          corner.closed = true;
          break;
        }
      }
      std::uint32_t last = start;
      for (std::uint32_t h = start; h != kNoHalfEdge; h = walk.next_around(h)) {
        if (corner_of[h] == index) break;
        corner_of[h] = index;
        last = h;
      }
      if (!corner.closed) {
        corner.first_line = walk.line(start);
        corner.last_line = walk.line(HalfEdges::previous(last));
      }
      first_half_edge.push_back(start);
      cut.corners.push_back(corner);
    }
  }

  cut.faces.resize(mesh.faces.size());
  for (std::uint32_t h = 0; h < half_edge_count; ++h) cut.faces[h / 3][h % 3] = corner_of[h];

  cut.fans.reserve(half_edge_count + cut.corners.size());
  for (std::size_t c = 0; c < cut.corners.size(); ++c) {
    Corner& corner = cut.corners[c];
    corner.fan_begin = static_cast<std::uint32_t>(cut.fans.size());
    const std::uint32_t start = first_half_edge[c];
    for (std::uint32_t h = start;;) {
      cut.fans.push_back(corner_of[HalfEdges::next(h)]);
      const std::uint32_t next = walk.next_around(h);
      if (next == kNoHalfEdge) {
        cut.fans.push_back(corner_of[HalfEdges::previous(h)]);
        break;
      }
      if (next == start) break;
      h = next;
    }
    corner.fan_end = static_cast<std::uint32_t>(cut.fans.size());
  }
  return cut;
}

}  // namespace knotreel::mesh
