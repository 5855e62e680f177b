// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/knots/place.h"
#include "knotreel/mesh/editable_mesh.h"
#include "knotreel/vectorize/options.h"

namespace knotreel::vectorize {

/// How knots are put into a mesh at first (paper sec. 6.1): as many as the MEC asks for, or as bring it to so
/// many control points, about.
knots::PlaceOptions first_knots(const mesh::EditableMesh& mesh, double functions, const Options& options);

/// Puts them in; with further rounds to come, a share of what the bound on control points allows.
void insert_first_knots(const knots::Target& target, std::size_t max_functions, const Options& options,
                        mesh::EditableMesh& mesh);

}  // namespace knotreel::vectorize
