// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "knotreel/mesh/knot_mesh.h"

namespace knotreel::bench {

/// A knot mesh like those of pictures: free knots at random with density varying by an order of magnitude,
/// simple knots along the sides, and feature polylines of a few segments each. Deterministic.
mesh::KnotMesh picture_mesh(double width, double height, int free_knots, int features,
                            std::uint64_t seed = 1);

}  // namespace knotreel::bench
