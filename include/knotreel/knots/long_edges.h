// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::knots {

/// Puts knots into faces with an edge longer than `longest`, near the middle of that edge, the longest first,
/// and restores Delaunay around each, until there are none or no room for a knot. On flat ground nothing else
/// asks for knots; then faces reach from the letters of one line to those of another far away, and what each
/// of them misses is spread over all that lies between (docs/decisions/0055).
/// New knots keep a sixteenth of `longest` away from others, from features and from the border.
/// @param mesh constrained Delaunay. @param longest pixels, > 0. @param most knots.
/// @return the number of knots inserted. Deterministic. Not thread safe.
std::size_t split_long_edges(mesh::EditableMesh& mesh, double longest, std::size_t most);

/// Whether there may be an edge longer than `longest` once a knot is gone.
bool keeps_edges_short(const mesh::EditableMesh& mesh, mesh::KnotIndex knot, double longest);

}  // namespace knotreel::knots
