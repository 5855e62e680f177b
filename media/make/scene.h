// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/image/image.h"

namespace knotreel::media {

/// A table with a vase, an apple, an egg and a striped cloth, by a window: smooth shading, cast shadows,
/// textured and striped parts, sharp edges, thin lines. RGB, any size; drawn with 4 x 4 samples per pixel.
image::Image still_life(int width, int height);

}  // namespace knotreel::media
