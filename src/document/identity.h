// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "document/frame_state.h"

/// What is the same knot and the same control point in two frames (docs/format.md, "Identities").
namespace knotreel::document {

inline constexpr std::uint32_t kNoMatch = 0xffffffffu;

/// For every element of a frame the index of the same one in the frame before, or kNoMatch.
struct Matches {
  std::vector<std::uint32_t> knots;
  std::vector<std::uint32_t> functions;
  std::vector<std::uint32_t> groups;
};

/// Everything matches itself.
Matches identity(const FrameState& state);

/// Knots with the same id.
std::vector<std::uint32_t> match_knots(const mesh::KnotMesh& mesh, const mesh::KnotMesh& before);

/// Corners of the same knot that are the same sector around it.
std::vector<std::uint32_t> match_corners(const mesh::KnotMesh& mesh, const mesh::CutMesh& cut,
                                         const mesh::KnotMesh& mesh_before, const mesh::CutMesh& cut_before);

/// Functions with the same I, as knot ids and the sectors around them.
std::vector<std::uint32_t> match_functions(const spline::SplineSpace& space,
                                           const spline::SplineSpace& before);

/// Geometry groups of the same knots.
/// @param knots as from match_knots().
std::vector<std::uint32_t> match_groups(const spline::SplineSpace& space, const spline::SplineSpace& before,
                                        const std::vector<std::uint32_t>& knots);

}  // namespace knotreel::document
