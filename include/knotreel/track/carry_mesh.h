// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/mesh/editable_mesh.h"

/// Vector models of a video: each frame's knot mesh comes from the frame before (docs/algorithm.md, "video").
namespace knotreel::track {

struct CarryOptions {
  double min_distance = 1.5;  ///< knots of a face that gets flatter than a quarter of it are crowded; pixels
};

struct CarryReport {
  std::size_t moved = 0;    ///< knots that are elsewhere now
  std::size_t removed = 0;  ///< free knots that left the domain, or that others crowded out
  std::size_t held = 0;     ///< knots that had to stay, because the mesh would have folded over
  std::size_t flips = 0;
  std::size_t segments_dropped = 0;  ///< feature segments that left the domain or were lost
  std::vector<std::size_t> stuck;    ///< segments with an end that had to stay away from its target
};

/// Where the knots of a mesh should go, from where the picture goes at each of them: domain corners and
/// simple border knots stay, other knots on a side slide along it, and knots inside segments keep their place
/// between the ends.
/// @param motion by knot, pixels.
std::vector<Vec2> knot_targets(const mesh::KnotMesh& mesh, std::span<const Vec2> motion);

/// Moves all knots of a mesh at once. Where faces would fold over or get too flat, it is mended: first by
/// flips, then by taking a free knot away, at last by letting knots stay. Segments with an end outside the
/// domain are given up; their knots become free ones. Ids are kept. Nothing that does not move changes.
/// @param mesh     sound. @param targets by knot, as knot_targets() gives them.
/// @param lost 1 for segments to be given up too; empty: none.
/// @return a sound mesh.
mesh::KnotMesh carry_mesh(const mesh::KnotMesh& mesh, std::span<const Vec2> targets,
                          std::span<const std::uint8_t> lost = {}, const CarryOptions& options = {},
                          CarryReport* report = nullptr);

}  // namespace knotreel::track
