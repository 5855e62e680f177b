// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/carried_links.h"

#include <algorithm>

#include "knotreel/knots/link_choice.h"
#include "knotreel/mesh/cut_mesh.h"

namespace knotreel::track {

namespace {

constexpr double kLeastArea = 0.02;  // squared pixels; flatter triangles make steep functions

std::vector<std::uint32_t> corner_ids(const mesh::KnotMesh& mesh, const mesh::CutMesh& cut) {
  std::vector<std::uint32_t> ids;
  ids.reserve(cut.corners.size());
  for (const mesh::Corner& c : cut.corners) {
    ids.push_back(static_cast<std::uint32_t>(mesh.knots[c.knot].id));
  }
  return ids;
}

bool all_positive(std::span<const spline::PolygonTriangle> triangles, std::span<const Vec2> positions) {
  return std::all_of(triangles.begin(), triangles.end(), [&](spline::PolygonTriangle t) {
    std::sort(t.begin(), t.end());  // positive order of the polygon
    return signed_area(positions[t[0]], positions[t[1]], positions[t[2]]) > kLeastArea;
  });
}

}  // namespace

LinkMemory::LinkMemory(const spline::SplineSpace& space)
    : links_(space, corner_ids(space.mesh(), space.cut())) {}

spline::SplineSpace LinkMemory::space_over(mesh::KnotMesh mesh, int degree,
                                           const knots::Target& target) const {
  const std::vector<std::uint32_t> ids = corner_ids(mesh, mesh::cut_open(mesh));
  const spline::LinkPolicy choose = knots::picture_links(target);
  return {std::move(mesh), degree,
          [&](const spline::LinkPolygon& polygon, std::vector<std::uint16_t>& codes) {
            const spline::NamedLinks::Triangles found = links_.find(polygon, ids);
            const std::span<const spline::PolygonTriangle> known(found.data(), found.size());
            if (!known.empty() && all_positive(known, polygon.positions)) {
              return spline::encode_triangulation(polygon.corners.size(), known, codes);
            }
            choose(polygon, codes);
          },
          spline::LinkOrder::kAny};
}

}  // namespace knotreel::track
