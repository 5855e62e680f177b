// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/mesh/knot_mesh.h"
#include "knotreel/motion/unchanged.h"
#include "knotreel/track/carry_mesh.h"
#include "knotreel/track/motion.h"
#include "track/fitted_frame.h"

namespace knotreel::track {

/// Where the geometry of a frame takes the knots of a mesh in the image.
std::vector<Vec2> image_positions(const FittedFrame& frame, const mesh::KnotMesh& mesh);

/// A mesh in the next picture: knots go where the motion takes them, features where their edges have gone,
/// and what rests stays. Segments whose edge is gone, or that cannot follow, are given up.
/// @param frame  the last one. @param mesh prepared for the next one from that of the frame.
/// @param motion from the picture of the frame to the next one.
mesh::KnotMesh carried_mesh(const FittedFrame& frame, const mesh::KnotMesh& mesh, const Motion& motion,
                            const motion::Rest& rest, const CarryOptions& options, CarryReport& report);

}  // namespace knotreel::track
