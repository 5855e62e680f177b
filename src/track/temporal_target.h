// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "knotreel/image/image.h"
#include "knotreel/track/motion.h"

namespace knotreel::track {

/// The picture without a share of what the frame before missed, taken along the motion: the surface is asked
/// for what changes rather than for what it cannot hold, and noise leaves it alone. Where the motion is not
/// trusted, and on features, the picture itself. Where nothing moves the share counts twice, 1 - (1 -
/// share)^2, but not of what was missed by far more than elsewhere: an edge out of place is to be mended.
/// Thread safe.
/// @param residual picture minus surface of the frame before, row-major, channels interleaved.
/// @param weights  of its pixels, empty: all 1. @param share 0 to 1, along the motion.
/// @param tiles    of 8x8 pixels, row-major: 1 for those that are asked for, others may be anything; or none:
///                 all are.
image::Image temporal_target(const image::Image& picture, std::span<const float> residual,
                             std::span<const float> weights, const Motion& motion, double share,
                             std::span<const std::uint8_t> tiles = {});

}  // namespace knotreel::track
