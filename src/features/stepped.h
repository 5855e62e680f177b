// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/features/chains.h"
#include "knotreel/image/image.h"

namespace knotreel::features {

/// Whether a picture goes from the colour of one side of a curve to that of the other in a single step, as
/// pictures of two colours and drawings without antialiasing do: nowhere along nine tenths of the curve, in
/// 3x3 pixels, is there a colour in between. Where such an edge lies is known to half a pixel.
/// @param scale  pixels of the chain per pixel of the picture, 1 or 2
bool is_stepped(const image::Image& image, const Chain& chain, int scale);

}  // namespace knotreel::features
