// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/image/image.h"

namespace knotreel::image {

/// Whether 3x3 pixels have next to nothing but two colours, by the channel that differs most; not if they
/// hardly differ at all. @param left, top of the pixels, which are all in the picture.
bool has_two_colours(const Image& picture, int left, int top);

}  // namespace knotreel::image
