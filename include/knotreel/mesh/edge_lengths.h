// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "knotreel/mesh/knot_mesh.h"

namespace knotreel::mesh {

/// Length of the shortest edge at each knot, pixels.
std::vector<double> shortest_edges(const KnotMesh& mesh);

}  // namespace knotreel::mesh
