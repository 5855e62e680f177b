// SPDX-License-Identifier: GPL-3.0-or-later
#include "spline/family.h"

#include <algorithm>

namespace knotreel::spline {

std::vector<FamilyConfig> face_family(const mesh::CutMesh& cut) {
  std::vector<FamilyConfig> family;
  family.reserve(cut.faces.size());
  for (const auto& face : cut.faces) family.push_back({face, {kNoCorner, kNoCorner}});
  return family;
}

namespace {

/// Vertex v of config `place / 3` at place `place % 3` of its triangle, with J = I + v.
struct Member {
  std::array<CornerIndex, 3> knots;
  std::uint32_t place;
};

/// All members by J, then by place: counted by each corner of J, the last one first, because a pass keeps the
/// order of equals.
std::vector<Member> sorted_members(std::span<const FamilyConfig> family, int level) {
  std::vector<Member> members;
  members.reserve(3 * family.size());
  CornerIndex largest = 0;
  for (std::uint32_t c = 0; c < family.size(); ++c) {
    for (std::uint32_t i = 0; i < 3; ++i) {
      std::array<CornerIndex, 3> knots{family[c].inner[0], family[c].inner[1], kNoCorner};
      largest = std::max(largest, family[c].triangle[i]);
      knots[static_cast<std::size_t>(level)] = family[c].triangle[i];
      // Ascending; kNoCorner is the largest and stays behind.
      if (knots[0] > knots[1]) std::swap(knots[0], knots[1]);
      if (knots[1] > knots[2]) std::swap(knots[1], knots[2]);
      if (knots[0] > knots[1]) std::swap(knots[0], knots[1]);
      members.push_back({knots, 3 * c + i});
    }
  }
  for (const FamilyConfig& c : family) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(level); ++i) largest = std::max(largest, c.inner[i]);
  }
  std::vector<Member> sorted(members.size());
  for (auto key = static_cast<std::size_t>(level) + 1; key-- > 0;) {
    std::vector<std::uint32_t> cursor(static_cast<std::size_t>(largest) + 2, 0);
    for (const Member& m : members) ++cursor[m.knots[key] + 1];
    for (std::size_t k = 1; k < cursor.size(); ++k) cursor[k] += cursor[k - 1];
    for (const Member& m : members) sorted[cursor[m.knots[key]]++] = m;
    members.swap(sorted);
  }
  return members;
}

/// Comparing arrays as a whole costs a call of memcmp.
bool same_knots(const std::array<CornerIndex, 3>& a, const std::array<CornerIndex, 3>& b) {
  return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

}  // namespace

void for_each_vertex(std::span<const FamilyConfig> family, int level,
                     const std::function<void(LinkVertex&)>& visit) {
  const std::vector<Member> members = sorted_members(family, level);
  LinkVertex vertex;
  for (std::size_t i = 0; i < members.size();) {
    vertex.knots = members[i].knots;
    vertex.edges.clear();
    vertex.members.clear();
    for (; i < members.size() && same_knots(members[i].knots, vertex.knots); ++i) {
      const std::uint32_t place = members[i].place;
      const auto& t = family[place / 3].triangle;
      vertex.edges.push_back({t[(place + 1) % 3], t[(place + 2) % 3]});
      vertex.members.push_back(place);
    }
    cancel_opposite(vertex.edges);
    visit(vertex);
  }
}

namespace {

/// @param loop of the link of the first `count` corners of J, starting with the smallest corner.
void append_loop(const mesh::CutMesh& cut, const std::array<CornerIndex, 3>& vertex, std::size_t count,
                 SmallVector<CornerIndex, 8> loop, std::vector<LinkLoop>& loops) {
  const std::span knots(vertex.data(), count);
  const auto is_copy = [&](CornerIndex c) {
    return cut.corners[c].multiple && std::find(knots.begin(), knots.end(), c) != knots.end();
  };
  bool fan = loop.size() == 3;
  if (!fan) {
    const auto copy = std::find_if(loop.begin(), loop.end(), is_copy);
    fan = copy != loop.end();
    if (fan) std::rotate(loop.begin(), copy, loop.end());
  }
  loops.push_back({vertex, std::move(loop), fan});
}

}  // namespace

std::vector<LinkLoop> corner_loops(const mesh::CutMesh& cut) {
  std::vector<LinkLoop> loops;
  loops.reserve(cut.corners.size());
  for (CornerIndex c = 0; c < cut.corners.size(); ++c) {
    const mesh::Corner& corner = cut.corners[c];
    const auto fan = cut.fan(c);
    const bool through_copy = corner.multiple && !corner.closed;
    if (fan.size() + (through_copy ? 1 : 0) < 3) continue;
    SmallVector<CornerIndex, 8> loop(fan.begin(), fan.end());
    if (through_copy) loop.push_back(c);
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    append_loop(cut, {c, kNoCorner, kNoCorner}, 1, std::move(loop), loops);
  }
  return loops;
}

void append_loops(const mesh::CutMesh& cut, LinkVertex& vertex, int level, std::vector<std::uint32_t>& place,
                  std::vector<LinkLoop>& loops) {
  const std::span<const CornerIndex> knots(vertex.knots.data(), static_cast<std::size_t>(level) + 1);
  for (const std::vector<CornerIndex>& loop : link_loops(cut, knots, vertex.edges, place)) {
    append_loop(cut, vertex.knots, knots.size(), {loop.begin(), loop.end()}, loops);
  }
}

void append_fan(const LinkLoop& loop, std::vector<std::array<CornerIndex, 3>>& triangles) {
  for (std::size_t i = 1; i + 1 < loop.corners.size(); ++i) {
    triangles.push_back({loop.corners[0], loop.corners[i], loop.corners[i + 1]});
  }
}

}  // namespace knotreel::spline
