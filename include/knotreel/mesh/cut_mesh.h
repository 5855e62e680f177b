// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/mesh/knot_mesh.h"

namespace knotreel::mesh {

using CornerIndex = std::uint32_t;

/// A straight line along which the surface may break: a feature segment or a side of the domain, from one
/// kVertex knot to the other. Knots on it are exactly on it by definition, whatever their rounded
/// coordinates.
struct Line {
  Vec2 from;
  Vec2 to;
};

inline constexpr std::uint32_t kNoLine = 0xffffffffu;

/// One copy of a knot per sector between consecutive feature or border edges around it.
struct Corner {
  KnotIndex knot = 0;
  bool multiple = false;        ///< the knot is of kind kVertex
  bool closed = false;          ///< the fan goes all round (knots off the features and the border)
  std::uint32_t fan_begin = 0;  ///< neighbours in positive order: CutMesh::fans[fan_begin, fan_end)
  std::uint32_t fan_end = 0;
  std::uint32_t first_line = kNoLine;  ///< of an open fan: the line along its first edge
  std::uint32_t last_line = kNoLine;   ///< of an open fan: the line along its last edge
};

/// The knot mesh cut open along its features (docs/algorithm.md, "cut mesh"): a triangulation whose vertices
/// are corners, so that nothing reaches across a feature. Pure combinatorics, apart from the positions.
struct CutMesh {
  std::vector<Corner> corners;
  std::vector<std::array<CornerIndex, 3>> faces;  ///< parallel to KnotMesh::faces, same rotation
  std::vector<CornerIndex> fans;                  ///< for an open fan: first and last are along the cut
  std::vector<Line> lines;                        ///< feature segments in order, then the four sides

  std::span<const CornerIndex> fan(CornerIndex c) const {
    return std::span(fans).subspan(corners[c].fan_begin, corners[c].fan_end - corners[c].fan_begin);
  }
};

/// Cuts a sound mesh (see find_topological_defect) along its segments. Corners are numbered by knot, and for
/// one knot by the sector that holds the first face of the mesh in face order.
CutMesh cut_open(const KnotMesh& mesh);

}  // namespace knotreel::mesh
