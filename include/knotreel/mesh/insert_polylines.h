// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::mesh {

/// Simple knots inside a feature segment of this length (paper sec. 6.1): one to three, about `spacing`
/// apart.
int knots_inside_segment(double length, double spacing);

struct InsertOptions {
  double clearance = 3;      ///< least distance of new segments from others and from the border, pixels
  double knot_distance = 2;  ///< free knots nearer to a new segment go, pixels
  double spacing = 12;       ///< as for knots_inside_segment()
};

/// Makes open polylines features of a mesh: their vertices become multiple knots, with simple ones between
/// them, and edges are flipped until each piece is one. A polyline that would come too near to a segment
/// there is, to the border, to a polyline before it or to itself is left out, as is one whose vertices do not
/// fit between the knots that must stay.
/// @param lines  in the domain, two vertices or more each.
/// @return by polyline, the knots it got: ends of segments and those between, in order; none if it was left
/// out, in which case the mesh is as it was.
std::vector<std::vector<KnotIndex>> insert_polylines(EditableMesh& mesh,
                                                     std::span<const std::vector<Vec2>> lines,
                                                     const InsertOptions& options = {});

}  // namespace knotreel::mesh
