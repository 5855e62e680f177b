#include "spline/family.h"

#include <algorithm>

namespace knotreel::spline {

std::vector<FamilyConfig> face_family(const mesh::CutMesh& cut) {
  std::vector<FamilyConfig> family;
  family.reserve(cut.faces.size());
  for (const auto& face : cut.faces) family.push_back({face, {kNoCorner, kNoCorner}});
  return family;
}

void for_each_vertex(std::span<const FamilyConfig> family, int level,
                     const std::function<void(LinkVertex&)>& visit) {
  struct Member {
    std::array<CornerIndex, 3> knots;
    std::uint32_t place;
  };
  std::vector<Member> members;
  members.reserve(3 * family.size());
  for (std::uint32_t c = 0; c < family.size(); ++c) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      std::array<CornerIndex, 3> knots{family[c].inner[0], family[c].inner[1], kNoCorner};
      knots[static_cast<std::size_t>(level)] = family[c].triangle[i];
      std::sort(knots.begin(), knots.end());  // kNoCorner is the largest and stays behind
      members.push_back({knots, 3 * c + i});
    }
  }
  std::sort(members.begin(), members.end(), [](const Member& a, const Member& b) {
    return a.knots != b.knots ? a.knots < b.knots : a.place < b.place;
  });
  LinkVertex vertex;
  for (std::size_t i = 0; i < members.size();) {
    vertex.knots = members[i].knots;
    vertex.edges.clear();
    vertex.members.clear();
    for (; i < members.size() && members[i].knots == vertex.knots; ++i) {
      const std::uint32_t place = members[i].place;
      const auto& t = family[place / 3].triangle;
      vertex.edges.push_back({t[(place + 1) % 3], t[(place + 2) % 3]});
      vertex.members.push_back(place);
    }
    cancel_opposite(vertex.edges);
    visit(vertex);
  }
}

std::vector<std::array<CornerIndex, 3>> link_triangles(const SplineSpace& space, LinkVertex& vertex,
                                                       int level, const Triangulator& triangulator,
                                                       std::vector<std::uint32_t>& place) {
  const mesh::CutMesh& cut = space.cut();
  const std::span<const CornerIndex> knots(vertex.knots.data(), static_cast<std::size_t>(level) + 1);
  const auto is_copy = [&](CornerIndex c) {
    return cut.corners[c].multiple && std::find(knots.begin(), knots.end(), c) != knots.end();
  };
  std::vector<std::array<CornerIndex, 3>> result;
  std::vector<PolygonTriangle> triangles;
  std::vector<Vec2> positions;
  for (std::vector<CornerIndex>& loop : link_loops(cut, knots, vertex.edges, place)) {
    triangles.clear();
    const auto n = static_cast<std::uint32_t>(loop.size());
    if (n == 3) {
      triangles.push_back({0, 1, 2});
    } else if (const auto copy = std::find_if(loop.begin(), loop.end(), is_copy); copy != loop.end()) {
      std::rotate(loop.begin(), copy, loop.end());
      for (std::uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
    } else {
      positions.clear();
      for (const CornerIndex c : loop) positions.push_back(space.position(c));
      triangulator({knots, loop, positions}, triangles);
    }
    for (const PolygonTriangle& t : triangles) result.push_back({loop[t[0]], loop[t[1]], loop[t[2]]});
  }
  return result;
}

}  // namespace knotreel::spline
