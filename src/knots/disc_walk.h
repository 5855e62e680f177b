// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <vector>

#include "knotreel/mesh/editable_mesh.h"

/// What lies within a distance of a point of a mesh, by a walk over the faces that the disc touches: the
/// nearest knot or feature need not be one of the face that the point is in.
namespace knotreel::knots {

/// @param start  the face that p is in. @param visit is told each face, and whether to go on is its answer;
/// @param reach  is told each edge nearer than the radius, and whether to go on is its answer.
/// @return whether all answers were yes.
template <class Visit, class Reach>
bool walk_disc(const mesh::EditableMesh& mesh, mesh::FaceIndex start, Vec2 p, double radius, Visit&& visit,
               Reach&& reach) {
  std::vector<mesh::FaceIndex> open{start};
  for (std::size_t i = 0; i < open.size(); ++i) {
    const mesh::FaceIndex f = open[i];
    if (!visit(f)) return false;
    const auto t = mesh.triangle(f);
    for (int side = 0; side < 3; ++side) {
      const auto at = static_cast<std::size_t>(side);
      if (distance_to_segment(p, t[(at + 1) % 3], t[(at + 2) % 3]) >= radius) continue;
      if (!reach(mesh::EditableMesh::Edge{f, side})) return false;
      const mesh::FaceIndex next = mesh.neighbour(f, side);
      if (next == mesh::kNoFace || std::find(open.begin(), open.end(), next) != open.end()) continue;
      open.push_back(next);
    }
  }
  return true;
}

inline bool far_from_knots(const mesh::EditableMesh& mesh, mesh::FaceIndex start, Vec2 p, double distance) {
  return walk_disc(
      mesh, start, p, distance,
      [&](mesh::FaceIndex f) {
        const auto t = mesh.triangle(f);
        return std::all_of(t.begin(), t.end(), [&](Vec2 q) { return norm(p - q) >= distance; });
      },
      [](mesh::EditableMesh::Edge) { return true; });
}

/// Whether no feature and no side of the domain is nearer.
inline bool far_from_lines(const mesh::EditableMesh& mesh, mesh::FaceIndex start, Vec2 p, double distance) {
  return walk_disc(
      mesh, start, p, distance, [](mesh::FaceIndex) { return true; },
      [&](mesh::EditableMesh::Edge e) { return !mesh.is_fixed(e); });
}

}  // namespace knotreel::knots
