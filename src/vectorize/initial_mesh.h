// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/mesh/knot_mesh.h"
#include "knotreel/param/parametrization.h"

namespace knotreel::vectorize {

/// The knots that features ask for (paper sec. 6.1): the domain corners and polyline vertices as multiple
/// knots, and one to three simple knots on each feature segment, about `spacing` pixels apart; triangulated.
/// @param shortest  segments of less, in pixels, have no knots inside, but for polylines of a single one: two
/// or three points of a curve tell no more than one bend.
/// @throws Error{kInvalidArgument} if the polylines make no sound mesh.
mesh::KnotMesh initial_mesh(const param::Parametrization& parametrization, double spacing, double shortest);

}  // namespace knotreel::vectorize
