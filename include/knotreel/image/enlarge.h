// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/image/image.h"

namespace knotreel::image {

/// A picture and what enlarge_twofold() made of it.
struct Enlarged {
  Image original;
  Image image;
};

/// A picture twice as wide and high, as sharp as it can be told: the means of 2x2 pixels are about those of
/// the picture, and none leaves the range of the 3x3 pixels around. Cubic convolution, then corrections by
/// what these means miss (iterative back-projection).
/// @param known another picture, or null: where both are the same, nothing is done twice. It does not show.
/// @throws Error{kInvalidArgument} as make_image(). All threads are used; their number does not show.
Image enlarge_twofold(const Image& image, const Enlarged* known = nullptr);

}  // namespace knotreel::image
