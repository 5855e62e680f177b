// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/debug/canvas.h"
#include "knotreel/image/image.h"

namespace knotreel::cli::debug {

/// The length of the colour error of each pixel, seen on white where there is alpha, from black (0) over
/// violet, red and yellow to white (64 levels and more), on the scale of a square root so that small errors
/// show. The same scale for all pictures; a legend with levels is below.
Canvas heat_map(const image::Image& picture, const image::Image& rendering);

}  // namespace knotreel::cli::debug
