// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/knot_mesh.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <algorithm>
#include <cmath>

#include "mesh/half_edges.h"

namespace knotreel::mesh {

namespace {

using Defect = std::optional<std::string>;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

// Knots inside a segment may miss the straight line by this much (rounding of A + t (B - A)), in pixels.
constexpr double kCollinearTolerance = 1e-8;
// Beyond this size of the domain the tolerances of the evaluation (1e-9 px) no longer hold in doubles.
constexpr double kMaxDomain = 1e6;

std::string knot_name(KnotIndex k) {
  return "knot " + std::to_string(k);
}

Defect find_index_defect(const KnotMesh& mesh) {
  if (mesh.knots.size() < 4 || mesh.faces.size() < 2) return "fewer than 4 knots or 2 faces";
  if (mesh.faces.size() > 0x2aaaaaaau) return "too many faces";
  std::vector<bool> used(mesh.knots.size(), false);
  for (const Face& f : mesh.faces) {
    for (const KnotIndex k : f) {
      if (k >= mesh.knots.size()) return "a face refers to a knot that does not exist";
      used[k] = true;
    }
    if (f[0] == f[1] || f[1] == f[2] || f[2] == f[0]) return "a face has the same knot twice";
  }
  if (const auto it = std::find(used.begin(), used.end(), false); it != used.end()) {
    return knot_name(static_cast<KnotIndex>(it - used.begin())) + " belongs to no face";
  }
  return std::nullopt;
}

/// Whether all faces can be reached from the first one across edges.
bool in_one_piece(const HalfEdges& half_edges) {
  std::vector<bool> reached(half_edges.opposite.size() / 3, false);
  std::vector<std::uint32_t> open{0};
  reached[0] = true;
  std::size_t count = 0;
  while (!open.empty()) {
    const std::uint32_t f = open.back();
    open.pop_back();
    ++count;
    for (std::uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
      const std::uint32_t other = half_edges.opposite[h];
      if (other == kNoHalfEdge || reached[other / 3]) continue;
      reached[other / 3] = true;
      open.push_back(other / 3);
    }
  }
  return count == reached.size();
}

/// One border loop, every knot with a single fan of faces, connected, Euler characteristic of a disk.
Defect find_surface_defect(const KnotMesh& mesh, const HalfEdges& half_edges) {
  const std::size_t knots = mesh.knots.size();
  std::vector<std::uint32_t> border_from(knots, kNoHalfEdge);
  std::vector<std::uint32_t> faces_at(knots, 0);
  std::vector<std::uint32_t> some_half_edge(knots, kNoHalfEdge);
  std::size_t border_edges = 0;
  for (std::uint32_t h = 0; h < half_edges.opposite.size(); ++h) {
    const KnotIndex k = origin(mesh.faces, h);
    ++faces_at[k];
    some_half_edge[k] = h;
    if (half_edges.opposite[h] != kNoHalfEdge) continue;
    if (border_from[k] != kNoHalfEdge) return knot_name(k) + " lies on the border twice";
    border_from[k] = h;
    ++border_edges;
  }
  if (border_edges == 0) return "the mesh has no border";

  for (KnotIndex k = 0; k < knots; ++k) {
    const bool on_border = border_from[k] != kNoHalfEdge;
    const bool may_be = mesh.knots[k].kind == KnotKind::kBorder || mesh.knots[k].kind == KnotKind::kVertex;
    if (on_border && !may_be) return knot_name(k) + " lies on the border but is not of a border kind";
    if (!on_border && mesh.knots[k].kind == KnotKind::kBorder) return knot_name(k) + " is not on the border";
    // Walk the fan in positive order; a border knot starts at its border edge.
    const std::uint32_t start = on_border ? border_from[k] : some_half_edge[k];
    std::uint32_t h = start;
    std::uint32_t count = 0;
    do {
      ++count;
      h = half_edges.opposite[HalfEdges::previous(h)];
    } while (h != kNoHalfEdge && h != start && count <= faces_at[k]);
    if (count != faces_at[k]) return knot_name(k) + " joins parts of the mesh that share no edge";
  }

  std::size_t loop = 0;
  KnotIndex at = 0;
  while (border_from[at] == kNoHalfEdge) ++at;
  const KnotIndex first = at;
  do {
    at = target(mesh.faces, border_from[at]);
    if (border_from[at] == kNoHalfEdge) return "the border is open";
    ++loop;
  } while (at != first && loop <= border_edges);
  if (loop != border_edges) return "the border is not one loop";
  // The characteristic alone does not tell a disk from a disk and a torus.
  if (!in_one_piece(half_edges)) return "the mesh is not in one piece";
  const std::size_t edges = (half_edges.opposite.size() + border_edges) / 2;
  if (knots + mesh.faces.size() != edges + 1) return "the mesh is not a disk";
  return std::nullopt;
}

std::optional<std::uint32_t> find_half_edge(const KnotMesh& mesh, const std::vector<std::uint32_t>& order,
                                            KnotIndex a, KnotIndex b) {
  using Edge = std::pair<KnotIndex, KnotIndex>;
  const auto ascending = [](KnotIndex x, KnotIndex y) { return x < y ? Edge{x, y} : Edge{y, x}; };
  const auto edge = [&](std::uint32_t h) { return ascending(origin(mesh.faces, h), target(mesh.faces, h)); };
  const Edge wanted = ascending(a, b);
  const auto it = std::lower_bound(order.begin(), order.end(), wanted,
                                   [&](std::uint32_t h, const Edge& key) { return edge(h) < key; });
  if (it == order.end() || edge(*it) != wanted) return std::nullopt;
  return *it;
}

/// @param order as from sorted_half_edges().
Defect find_segment_defect(const KnotMesh& mesh, const HalfEdges& half_edges,
                           const std::vector<std::uint32_t>& order) {
  std::vector<std::uint32_t> ends_at(mesh.knots.size(), 0);
  std::vector<bool> inside(mesh.knots.size(), false);
  std::vector<bool> edge_taken(half_edges.opposite.size(), false);
  for (std::size_t s = 0; s < mesh.segments.size(); ++s) {
    const auto& knots = mesh.segments[s].knots;
    const std::string name = "segment " + std::to_string(s);
    if (knots.size() < 2) return name + " has fewer than two knots";
    for (std::size_t i = 0; i < knots.size(); ++i) {
      if (knots[i] >= mesh.knots.size()) return name + " refers to a knot that does not exist";
      const bool end = i == 0 || i + 1 == knots.size();
      if (mesh.knots[knots[i]].kind != (end ? KnotKind::kVertex : KnotKind::kSegment)) {
        return name + " has a knot of the wrong kind";
      }
      if (end) ++ends_at[knots[i]];
      if (!end && inside[knots[i]]) return knot_name(knots[i]) + " lies inside two segments";
      if (!end) inside[knots[i]] = true;
      if (i == 0) continue;
      const auto h = find_half_edge(mesh, order, knots[i - 1], knots[i]);
      if (!h) return name + " does not follow edges of the mesh";
      if (half_edges.opposite[*h] == kNoHalfEdge) return name + " runs along the border";
      if (edge_taken[*h] || edge_taken[half_edges.opposite[*h]]) return name + " shares an edge with another";
      edge_taken[*h] = true;
    }
    if (knots.front() == knots.back()) return name + " ends where it starts";
  }
  std::vector<bool> on_border(mesh.knots.size(), false);
  for (std::uint32_t h = 0; h < half_edges.opposite.size(); ++h) {
    if (half_edges.opposite[h] == kNoHalfEdge) on_border[origin(mesh.faces, h)] = true;
  }
  const auto is_tip = [&](KnotIndex k) { return ends_at[k] == 1 && !on_border[k]; };
  for (const FeatureSegment& s : mesh.segments) {
    // The two sides of a segment between two tips would have the same corners at both ends.
    if (s.knots.size() == 2 && is_tip(s.knots[0]) && is_tip(s.knots[1])) {
      return "a segment between two tips needs a knot inside";
    }
  }
  for (KnotIndex k = 0; k < mesh.knots.size(); ++k) {
    if (mesh.knots[k].kind == KnotKind::kSegment && !inside[k]) return knot_name(k) + " is on no segment";
  }
  return std::nullopt;
}

Defect find_id_defect(const KnotMesh& mesh) {
  std::vector<KnotId> ids(mesh.knots.size());
  std::transform(mesh.knots.begin(), mesh.knots.end(), ids.begin(), [](const Knot& k) { return k.id; });
  std::sort(ids.begin(), ids.end());
  if (std::adjacent_find(ids.begin(), ids.end()) != ids.end()) return "two knots have the same id";
  return std::nullopt;
}

Defect find_position_defect(const KnotMesh& mesh) {
  const double w = mesh.width;
  const double h = mesh.height;
  if (!(w > 0 && h > 0 && w <= kMaxDomain && h <= kMaxDomain)) return "the domain has no usable size";
  int domain_corners = 0;
  std::vector<bool> ends_segment(mesh.knots.size(), false);
  for (const FeatureSegment& s : mesh.segments) {
    ends_segment[s.knots.front()] = true;
    ends_segment[s.knots.back()] = true;
  }
  for (KnotIndex k = 0; k < mesh.knots.size(); ++k) {
    const Vec2 p = mesh.knots[k].position;
    if (!(p.x >= 0 && p.x <= w && p.y >= 0 && p.y <= h)) return knot_name(k) + " is outside the domain";
    const bool on_x = p.x == 0 || p.x == w;
    const bool on_y = p.y == 0 || p.y == h;
    const KnotKind kind = mesh.knots[k].kind;
    if (on_x && on_y) {
      ++domain_corners;
      if (kind != KnotKind::kVertex) return knot_name(k) + " at a domain corner is not a vertex";
    } else if (kind == KnotKind::kVertex && !ends_segment[k]) {
      return knot_name(k) + " is a vertex without segments";
    }
    if ((on_x || on_y) && (kind == KnotKind::kFree || kind == KnotKind::kSegment)) {
      return knot_name(k) + " lies on a side of the domain but is not of a border kind";
    }
    if (kind == KnotKind::kBorder && !on_x && !on_y) return knot_name(k) + " is not on a side of the domain";
  }
  if (domain_corners != 4) return "the domain corners are not four knots";
  for (const FeatureSegment& s : mesh.segments) {
    const Vec2 a = mesh.knots[s.knots.front()].position;
    const Vec2 d = mesh.knots[s.knots.back()].position - a;
    const double length2 = dot(d, d);
    double last = 0;
    for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
      const Vec2 p = mesh.knots[s.knots[i]].position - a;
      if (std::abs(cross(d, p)) > kCollinearTolerance * std::sqrt(length2)) {
        return knot_name(s.knots[i]) + " is off its segment";
      }
      const double along = dot(d, p);
      if (!(along > last && along < length2))
        return knot_name(s.knots[i]) + " is out of order on its segment";
      last = along;
    }
  }
  return std::nullopt;
}

/// Every border edge runs along one side of the domain, with the inside on its left.
Defect find_border_defect(const KnotMesh& mesh) {
  const auto may_be_outside = [&](KnotIndex k) {
    return mesh.knots[k].kind == KnotKind::kBorder || mesh.knots[k].kind == KnotKind::kVertex;
  };
  std::vector<std::pair<KnotIndex, KnotIndex>> edges;
  for (const Face& f : mesh.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      const KnotIndex from = f[i];
      const KnotIndex to = f[(i + 1) % 3];
      if (may_be_outside(from) && may_be_outside(to)) edges.emplace_back(from, to);
    }
  }
  std::sort(edges.begin(), edges.end());
  for (const auto& [from, to] : edges) {
    if (std::binary_search(edges.begin(), edges.end(), std::pair(to, from))) continue;
    const Vec2 a = mesh.knots[from].position;
    const Vec2 b = mesh.knots[to].position;
    const bool along =
        (a.y == 0 && b.y == 0 && b.x > a.x) || (a.x == mesh.width && b.x == mesh.width && b.y > a.y) ||
        (a.y == mesh.height && b.y == mesh.height && b.x < a.x) || (a.x == 0 && b.x == 0 && b.y < a.y);
    if (!along) return "a border edge does not follow a side of the domain";
  }
  return std::nullopt;
}

/// Faces on one line are refused by name, because their orientation is only rounding.
Defect find_face_defect(const KnotMesh& mesh) {
  std::vector<std::vector<std::uint32_t>> lines(mesh.knots.size());
  for (std::uint32_t s = 0; s < mesh.segments.size(); ++s) {
    for (const KnotIndex k : mesh.segments[s].knots) lines[k].push_back(s);
  }
  const auto point = [&](KnotIndex k) {
    return Kernel::Point_2(mesh.knots[k].position.x, mesh.knots[k].position.y);
  };
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto& [a, b, c] = mesh.faces[f];
    if (CGAL::orientation(point(a), point(b), point(c)) != CGAL::POSITIVE) {
      return "face " + std::to_string(f) + " is flipped or flat";
    }
    // The shortest list first: a star of many segments has one long list, and its faces have two short ones.
    std::array<KnotIndex, 3> by_lines{a, b, c};
    std::sort(by_lines.begin(), by_lines.end(),
              [&](KnotIndex p, KnotIndex q) { return lines[p].size() < lines[q].size(); });
    for (const std::uint32_t s : lines[by_lines[0]]) {
      const auto on = [&](KnotIndex k) { return std::binary_search(lines[k].begin(), lines[k].end(), s); };
      if (on(by_lines[1]) && on(by_lines[2])) return "face " + std::to_string(f) + " lies on one segment";
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> find_topological_defect(const KnotMesh& mesh) {
  if (Defect d = find_index_defect(mesh)) return d;
  const std::vector<std::uint32_t> order = sorted_half_edges(mesh.faces);
  const std::optional<HalfEdges> half_edges = connect_half_edges(mesh.faces, order);
  if (!half_edges) return "an edge has more than two faces, or faces turn different ways";
  if (Defect d = find_surface_defect(mesh, *half_edges)) return d;
  return find_segment_defect(mesh, *half_edges, order);
}

std::optional<std::string> find_geometric_defect(const KnotMesh& mesh) {
  if (Defect d = find_position_defect(mesh)) return d;
  if (Defect d = find_border_defect(mesh)) return d;
  return find_face_defect(mesh);
}

std::optional<std::string> find_defect(const KnotMesh& mesh) {
  if (Defect d = find_topological_defect(mesh)) return d;
  if (Defect d = find_id_defect(mesh)) return d;
  return find_geometric_defect(mesh);
}

}  // namespace knotreel::mesh
