#include "track/carried_links.h"

#include <algorithm>

#include "knotreel/knots/link_choice.h"
#include "knotreel/mesh/cut_mesh.h"

namespace knotreel::track {

namespace {

constexpr double kLeastArea = 0.02;  // squared pixels; flatter triangles make steep functions

std::vector<std::uint32_t> corner_ids(const mesh::KnotMesh& mesh) {
  std::vector<std::uint32_t> ids;
  for (const mesh::Corner& c : mesh::cut_open(mesh).corners) {
    ids.push_back(static_cast<std::uint32_t>(mesh.knots[c.knot].id));
  }
  return ids;
}

struct Named {
  std::vector<std::uint32_t> name;
  std::uint32_t turn;  ///< place in the polygon where the name's ring begins
};

Named name_of(const spline::LinkPolygon& polygon, const std::vector<std::uint32_t>& ids) {
  Named result;
  for (const mesh::CornerIndex c : polygon.vertex) result.name.push_back(ids[c]);
  std::sort(result.name.begin(), result.name.end());
  std::vector<std::uint32_t> ring;
  for (const mesh::CornerIndex c : polygon.corners) ring.push_back(ids[c]);
  const auto least = std::min_element(ring.begin(), ring.end());
  result.turn = static_cast<std::uint32_t>(least - ring.begin());
  std::rotate(ring.begin(), least, ring.end());
  result.name.insert(result.name.end(), ring.begin(), ring.end());
  return result;
}

std::vector<spline::PolygonTriangle> turned(std::vector<spline::PolygonTriangle> triangles, std::uint32_t by,
                                            std::size_t n) {
  for (auto& t : triangles) {
    for (std::uint32_t& place : t) place = static_cast<std::uint32_t>((place + by) % n);
  }
  return triangles;
}

bool all_positive(const std::vector<spline::PolygonTriangle>& triangles, std::span<const Vec2> positions) {
  return std::all_of(triangles.begin(), triangles.end(), [&](spline::PolygonTriangle t) {
    std::sort(t.begin(), t.end());  // positive order of the polygon
    return signed_area(positions[t[0]], positions[t[1]], positions[t[2]]) > kLeastArea;
  });
}

}  // namespace

LinkMemory::LinkMemory(const spline::SplineSpace& space) {
  const std::vector<std::uint32_t> ids = corner_ids(space.mesh());
  std::span<const std::uint16_t> codes = space.link_codes();
  const spline::SplineSpace again(
      space.mesh(), space.degree(), [&](const spline::LinkPolygon& polygon, std::vector<std::uint16_t>& out) {
        const std::size_t n = polygon.corners.size();
        std::vector<spline::PolygonTriangle> triangles;
        const std::size_t used = spline::decode_triangulation(n, codes, triangles).value();
        out.insert(out.end(), codes.begin(), codes.begin() + static_cast<std::ptrdiff_t>(used));
        codes = codes.subspan(used);
        Named named = name_of(polygon, ids);
        triangles_.emplace(std::move(named.name),
                           turned(std::move(triangles), static_cast<std::uint32_t>(n - named.turn), n));
      });
}

spline::SplineSpace LinkMemory::space_over(mesh::KnotMesh mesh, int degree,
                                           const knots::Target& target) const {
  const std::vector<std::uint32_t> ids = corner_ids(mesh);
  const spline::LinkPolicy choose = knots::picture_links(target);
  return {std::move(mesh), degree,
          [&](const spline::LinkPolygon& polygon, std::vector<std::uint16_t>& codes) {
            const Named named = name_of(polygon, ids);
            const auto known = triangles_.find(named.name);
            if (known != triangles_.end()) {
              const std::size_t n = polygon.corners.size();
              const auto triangles = turned(known->second, named.turn, n);
              if (all_positive(triangles, polygon.positions)) {
                return spline::encode_triangulation(n, triangles, codes);
              }
            }
            choose(polygon, codes);
          },
          spline::LinkOrder::kAny};
}

}  // namespace knotreel::track
