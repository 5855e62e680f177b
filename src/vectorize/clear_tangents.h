// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "knotreel/fit/geometry_fit.h"
#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::vectorize {

/// Makes room for curves to leave the ends of their segments (docs/decisions/0043). An edge of the mesh that
/// leaves a vertex along the tangent of a curve there, or between it and the segment, makes a face that folds
/// when the curve is bent, as between things that stand in a row. Such edges are flipped where the picture
/// does not mind; else a knot comes beside them, and they are flipped then.
/// @param curves points of features, in their order along each segment; those of a closed feature may begin
/// inside its last segment. @param segments of the mesh, parallel to these.
/// @param inside knots inside segments, too, at which edges are flipped but no knots come beside them: a
/// curve leaves its segment by little there.
/// @param most knots to insert. @param min_distance of these from others, pixels.
/// @return how many were inserted.
std::size_t clear_tangents(mesh::EditableMesh& mesh, const knots::Target& target,
                           std::span<const fit::CurvePoint> curves, std::span<const std::uint32_t> segments,
                           bool inside, std::size_t most, double min_distance);

}  // namespace knotreel::vectorize
