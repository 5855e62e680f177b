#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

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

/// Triangulates a polygon with four or more corners that has no copy of J among its corners; appends
/// triangles.
using Triangulator = std::function<void(const LinkPolygon&, std::vector<PolygonTriangle>&)>;

/// Triangulates the link of one vertex of a family: fans around copies of a multiple corner of J, and what
/// `triangulator` chooses elsewhere.
/// @param place scratch space, see link_loops.
std::vector<std::array<CornerIndex, 3>> link_triangles(const SplineSpace& space, LinkVertex& vertex,
                                                       int level, const Triangulator& triangulator,
                                                       std::vector<std::uint32_t>& place);

}  // namespace knotreel::spline
