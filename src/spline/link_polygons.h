// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/mesh/cut_mesh.h"

namespace knotreel::spline {

using mesh::CornerIndex;
using DirectedEdge = std::array<CornerIndex, 2>;

/// Closed polygons, each starting with its smallest corner.
using Loops = std::vector<std::vector<CornerIndex>>;

inline constexpr std::uint32_t kNotOnPath = 0xffffffffu;

/// Removes pairs of opposite edges in place.
void cancel_opposite(std::vector<DirectedEdge>& edges);

/// The link of the vertex J of a t-config family, from the edges opposite J in its configs (already
/// cancelled): closes an open chain, by a copy of the multiple corner of J if the chain does not meet it yet,
/// and else by its chord; splits where a corner repeats. Edges are sorted on return.
/// @param vertex J, ascending, repeated corners repeated.
/// @param place  scratch space: one entry per corner of the mesh, all kNotOnPath; the same on return.
Loops link_loops(const mesh::CutMesh& cut, std::span<const CornerIndex> vertex,
                 std::vector<DirectedEdge>& edges, std::vector<std::uint32_t>& place);

}  // namespace knotreel::spline
