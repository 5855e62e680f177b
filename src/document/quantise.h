// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "document/canonical.h"
#include "document/frame_state.h"

/// From pixels and levels to integers.
namespace knotreel::document {

/// Knots on the coarsest grid from `least_bits` on that leaves the mesh sound; rewrites the positions in
/// `numbering.mesh`, which has no topological defect. Quantising the outcome again changes nothing.
/// @throws Error{kInvalidArgument} if no grid up to kMaxKnotBits does.
KnotGrid quantise_knots(CanonicalMesh& numbering, int least_bits);

/// round(value / step), halves away from zero.
/// @throws Error{kInvalidArgument} for a value that is not finite or beyond kMaxControl steps; `what` names
/// it.
std::int64_t quantise(double value, double step, const char* what);

}  // namespace knotreel::document
