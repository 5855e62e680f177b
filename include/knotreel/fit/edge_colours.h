// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/image/image.h"
#include "knotreel/mesh/knot_mesh.h"

namespace knotreel::fit {

/// Weight of pixels that a feature crosses and that have the colour of their side: enough to keep the surface
/// from overshooting where it ends, too little to blur it. Those without such a colour have none.
inline constexpr float kEdgeWeight = 0.1F;

/// Gives the pixels that a feature crosses the colour of the side on which their centre lies: the mean of the
/// neighbours there that no feature crosses. Pixels without such a neighbour keep their colour.
/// @param picture  is changed in place. @param places of the pixels in the domain. @param crossed 1 for
/// pixels that a feature crosses. @param mesh its segments are the features.
/// @return for each pixel 1 if it was given a colour.
std::vector<std::uint8_t> clear_edge_colours(image::Image& picture, std::span<const Vec2> places,
                                             std::span<const std::uint8_t> crossed,
                                             const mesh::KnotMesh& mesh);

/// Weights of all pixels then: 1 where no feature crosses.
/// @param given as clear_edge_colours() returns it.
std::vector<float> edge_weights(std::span<const std::uint8_t> crossed, std::span<const std::uint8_t> given);

}  // namespace knotreel::fit
