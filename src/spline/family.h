// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "base/small_vector.h"
#include "knotreel/spline/link.h"
#include "knotreel/spline/space.h"
#include "spline/link_polygons.h"

/// The link triangulation procedure (paper Algorithm 1) on a cut mesh.
namespace knotreel::spline {

/// A t-config of any level: I holds `level` corners, ascending, the rest kNoCorner.
struct FamilyConfig {
  std::array<CornerIndex, 3> triangle;
  std::array<CornerIndex, 2> inner;
};

/// The level-0 family: the faces of the cut mesh.
std::vector<FamilyConfig> face_family(const mesh::CutMesh& cut);

/// A vertex J = I + v of a family with what its configs say about its link.
struct LinkVertex {
  std::array<CornerIndex, 3> knots;    ///< J: level + 1 corners, ascending, the rest kNoCorner
  std::vector<DirectedEdge> edges;     ///< opposite J, opposite pairs cancelled
  std::vector<std::uint32_t> members;  ///< 3 * config + place of v in its triangle
};

/// Calls visit once per vertex of the family, in lexicographic order.
void for_each_vertex(std::span<const FamilyConfig> family, int level,
                     const std::function<void(LinkVertex&)>& visit);

/// One loop of the link of a vertex of a family.
struct LinkLoop {
  std::array<CornerIndex, 3> vertex;    ///< J, as in LinkVertex
  SmallVector<CornerIndex, 8> corners;  ///< positive order; a fan starts with its centre
  bool fan = false;                     ///< has one triangulation only: a triangle, or around a copy of J
};

/// The links of the vertices of the level-0 family, by corner: the link of one corner is its fan, closed as
/// append_loops() would do it.
std::vector<LinkLoop> corner_loops(const mesh::CutMesh& cut);

/// Appends the loops of the link of one vertex: fans around copies of a multiple corner of J, and polygons
/// with four or more corners, none of which is in J.
/// @param place scratch space, see link_loops.
void append_loops(const mesh::CutMesh& cut, LinkVertex& vertex, int level, std::vector<std::uint32_t>& place,
                  std::vector<LinkLoop>& loops);

/// Appends the triangles of a fan.
void append_fan(const LinkLoop& loop, std::vector<std::array<CornerIndex, 3>>& triangles);

}  // namespace knotreel::spline
