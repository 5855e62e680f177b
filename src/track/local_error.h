// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "knotreel/spline/space.h"

namespace knotreel::track {

/// Mean of the absolute values of a residual in the tile of 8x8 pixels that the Greville site of each
/// function lies in, levels.
/// @param residual one per pixel and channel, of a picture as large as the domain of the space.
/// Parallel over rows of tiles; same bits for any number of threads.
std::vector<double> local_errors(const spline::SplineSpace& space, std::span<const float> residual, int width,
                                 int height, int channels);

}  // namespace knotreel::track
