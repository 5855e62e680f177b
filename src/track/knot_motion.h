// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/mesh/knot_mesh.h"
#include "knotreel/track/motion.h"

namespace knotreel::track {

/// Motion of the knots of a mesh from one picture to the next, pixels. Those in the dead zone
/// (motion/still.h) stay, unless it is the same to the picture and most of their neighbours go: in their way
/// they would not stay for long.
/// @param points where the knots are in the picture before.
std::vector<Vec2> knot_motion(const mesh::KnotMesh& mesh, std::span<const Vec2> points, const Motion& motion);

}  // namespace knotreel::track
