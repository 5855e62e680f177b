// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/mesh/knot_mesh.h"
#include "knotreel/motion/unchanged.h"
#include "knotreel/spline/space.h"

namespace knotreel::track {

/// By knot, whether the picture rests in all of its faces, and some pixels around them since surfaces may be
/// displaced.
std::vector<std::uint8_t> resting_knots(const mesh::KnotMesh& mesh, const motion::Rest& rest);

/// By geometry control point of a space, whether all of its knots rest.
std::vector<std::uint8_t> resting_geometry(const spline::SplineSpace& space,
                                           const std::vector<std::uint8_t>& resting);

}  // namespace knotreel::track
