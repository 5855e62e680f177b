// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/mesh/knot_mesh.h"

namespace knotreel::mesh {

/// Constrained Delaunay triangulation of knots: fills in `faces` of a mesh whose knots and segments are
/// given. Exact predicates (CGAL); ties are broken by the order of the knots, so equal input gives equal
/// faces.
/// @throws Error{kInvalidArgument} if segments name no knots or cross, knots coincide, or the result has a
/// defect.
void triangulate(KnotMesh& mesh);

/// The four domain corners as kVertex knots with ids 0..3 (top left, top right, bottom right, bottom left)
/// and nothing else; faces are left empty.
KnotMesh make_domain(double width, double height);

}  // namespace knotreel::mesh
