// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "knotreel/image/image.h"

namespace knotreel::features {

/// Pixels of a photograph or film at the outlines of what was written over it: subtitles, banners, labels.
/// What a lens saw gets from dark to light in steps of at most some hundred levels from pixel to pixel;
/// letters do so in larger ones, along rows and columns close to each other. Counted are pixels with steps
/// above 50 levels, in any colour, in cells of 16x16 pixels where six are above 128 along rows, and along
/// columns, and 0.3 times as many are above 128 as above 50, which are at most three quarters of its pixels.
/// 0 if such cells are less than 1 % of all: films have up to 0.8 %, a line of subtitles 2 to 5 %; or more
/// than 40 %, as of screen tone. Drawings are full of them, too. Safe to call from several threads; same bits
/// for any number of threads.
std::size_t caption_pixels(const image::Image& image);

}  // namespace knotreel::features
