// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"
#include "knotreel/track/tracker.h"

namespace knotreel::track {

/// Moves new knots to where the picture wants them. Their neighbours stay, unless much is new: to disturb
/// knots that have settled is more flicker and bytes for the same error.
void optimise_new_knots(mesh::EditableMesh& mesh, const std::vector<mesh::KnotIndex>& fresh,
                        const knots::Target& target, const vectorize::Options& cold,
                        const TrackOptions& options);

}  // namespace knotreel::track
