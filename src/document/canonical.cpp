// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/canonical.h"

#include <algorithm>
#include <numeric>

#include "document/bytes.h"
#include "document/edge_table.h"
#include "knotreel/base/error.h"
#include "knotreel/spline/link.h"
#include "spline/named_links.h"

namespace knotreel::document {

using mesh::CornerIndex;
using spline::FunctionIndex;

namespace {

/// The border in positive order, from the top left corner on.
std::vector<KnotIndex> border_loop(const mesh::KnotMesh& mesh, const EdgeTable& edges) {
  std::vector<KnotIndex> next(mesh.knots.size(), kNoKnot);
  KnotIndex start = kNoKnot;
  for (KnotIndex a = 0; a < mesh.knots.size(); ++a) {
    for (const EdgeTable::Side& side : edges.from(a)) {
      if (edges.find(side.to, a)) continue;
      next[a] = side.to;
      if (mesh.knots[a].position == Vec2{0, 0}) start = a;
    }
  }
  if (start == kNoKnot) malformed("the mesh has no top left corner");
  std::vector<KnotIndex> loop;
  for (KnotIndex k = start; k != kNoKnot && loop.size() < mesh.knots.size(); k = next[k]) {
    loop.push_back(k);
    if (next[k] == start) return loop;
  }
  malformed("the border of the mesh is open");
}

std::vector<mesh::FeatureSegment> canonical_segments(const mesh::KnotMesh& mesh,
                                                     const std::vector<KnotIndex>& canonical) {
  std::vector<mesh::FeatureSegment> segments = mesh.segments;
  for (mesh::FeatureSegment& s : segments) {
    for (KnotIndex& k : s.knots) k = canonical[k];
    if (s.knots.front() > s.knots.back()) std::reverse(s.knots.begin(), s.knots.end());
  }
  std::sort(segments.begin(), segments.end(), [](const auto& x, const auto& y) { return x.knots < y.knots; });
  return segments;
}

bool same_numbering(const mesh::KnotMesh& given, const CanonicalMesh& numbering) {
  for (KnotIndex k = 0; k < numbering.knot_of.size(); ++k) {
    if (numbering.knot_of[k] != k) return false;
  }
  return given.faces == numbering.mesh.faces &&
         std::equal(given.segments.begin(), given.segments.end(), numbering.mesh.segments.begin(),
                    [](const auto& x, const auto& y) { return x.knots == y.knots; });
}

bool same_knots(const mesh::KnotMesh& a, const mesh::KnotMesh& b) {
  return std::ranges::equal(a.knots, b.knots, [](const mesh::Knot& x, const mesh::Knot& y) {
    return x.position == y.position && x.kind == y.kind && x.id == y.id;
  });
}

}  // namespace

CanonicalMesh canonical_mesh(const mesh::KnotMesh& mesh) {
  CanonicalMesh result;
  const EdgeTable edges(mesh.knots.size(), mesh.faces);
  const std::vector<KnotIndex> border = border_loop(mesh, edges);
  Conquered conquered = conquer(edges, border);
  result.conquest = std::move(conquered.conquest);
  result.knot_of = std::move(conquered.knot_of);
  result.face_of = std::move(conquered.face_of);
  result.border_count = static_cast<KnotIndex>(border.size());

  std::vector<KnotIndex> canonical(mesh.knots.size());
  result.mesh.width = mesh.width;
  result.mesh.height = mesh.height;
  for (KnotIndex k = 0; k < result.knot_of.size(); ++k) {
    canonical[result.knot_of[k]] = k;
    result.mesh.knots.push_back(mesh.knots[result.knot_of[k]]);
  }
  result.mesh.faces = result.conquest.faces;
  result.mesh.segments = canonical_segments(mesh, canonical);

  const Vec2 corners[] = {{0, 0}, {mesh.width, 0}, {mesh.width, mesh.height}, {0, mesh.height}};
  KnotIndex k = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    while (k < result.border_count && !(result.mesh.knots[k].position == corners[i])) ++k;
    if (k == result.border_count) malformed("a domain corner is not on the border of the mesh");
    result.domain_corners[i] = k;
  }
  return result;
}

std::vector<CornerIndex> corner_map(const mesh::CutMesh& given, const mesh::CutMesh& canonical,
                                    const CanonicalMesh& numbering) {
  std::vector<CornerIndex> map(given.corners.size());
  for (std::size_t f = 0; f < canonical.faces.size(); ++f) {
    const auto& from = given.faces[numbering.face_of[f]];
    const auto& to = canonical.faces[f];
    // The same face, perhaps rotated.
    const KnotIndex first = numbering.knot_of[canonical.corners[to[0]].knot];
    std::size_t turn = 0;
    while (given.corners[from[turn]].knot != first) ++turn;
    for (std::size_t i = 0; i < 3; ++i) map[from[(i + turn) % 3]] = to[i];
  }
  return map;
}

std::shared_ptr<const spline::SplineSpace> canonical_space(
    const std::shared_ptr<const spline::SplineSpace>& given, mesh::KnotMesh mesh,
    const CanonicalMesh& numbering) {
  if (same_numbering(given->mesh(), numbering)) {
    if (same_knots(given->mesh(), mesh)) return given;
    return std::make_shared<spline::SplineSpace>(
        spline::SplineSpace::from_link_codes(std::move(mesh), given->degree(), given->link_codes()));
  }
  const mesh::CutMesh cut = mesh::cut_open(mesh);
  const spline::NamedLinks links(*given, corner_map(given->cut(), cut, numbering));
  std::vector<CornerIndex> own_names(cut.corners.size());
  std::iota(own_names.begin(), own_names.end(), 0u);
  return std::make_shared<spline::SplineSpace>(
      std::move(mesh), given->degree(), [&](const spline::LinkPolygon& polygon, auto& codes) {
        const auto known = links.find(polygon, own_names);
        const std::size_t n = polygon.corners.size();
        if (!known.empty()) return spline::encode_triangulation(n, {known.data(), known.size()}, codes);
        // At degree 3, the link of two multiple corners can depend on the numbering: choose anew.
        spline::encode_triangulation(n, spline::triangulate_polygon(polygon.positions), codes);
      });
}

std::vector<FunctionIndex> function_map(const spline::SplineSpace& given,
                                        const spline::SplineSpace& canonical,
                                        const CanonicalMesh& numbering) {
  std::vector<FunctionIndex> map;
  if (&given == &canonical) {
    map.resize(given.function_count());
    std::iota(map.begin(), map.end(), FunctionIndex{0});
    return map;
  }
  const auto to_canonical = corner_map(given.cut(), canonical.cut(), numbering);
  std::vector<std::pair<std::array<CornerIndex, 3>, FunctionIndex>> mapped;
  mapped.reserve(given.function_count());
  for (FunctionIndex f = 0; f < given.function_count(); ++f) {
    std::array<CornerIndex, 3> knots = given.functions()[f].knots;
    for (CornerIndex& c : knots) {
      if (c != spline::kNoCorner) c = to_canonical[c];
    }
    std::sort(knots.begin(), knots.end());
    mapped.emplace_back(knots, f);
  }
  std::sort(mapped.begin(), mapped.end());
  for (const auto& [knots, f] : mapped) map.push_back(f);
  const bool same =
      std::equal(mapped.begin(), mapped.end(), canonical.functions().begin(), canonical.functions().end(),
                 [](const auto& m, const spline::Function& function) { return m.first == function.knots; });
  if (!same)
    throw Error(ErrorKind::kInternal, "the functions of a frame changed with the order of its knots");
  return map;
}

}  // namespace knotreel::document
