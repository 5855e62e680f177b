// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/image/image.h"

namespace knotreel::image {

/// How many columns or rows away from a pixel there may be others that what it is enlarged to hangs on.
inline constexpr int kReachOfEnlarging = 8;

/// A picture twice as wide and high, as sharp as it can be told: the means of 2x2 pixels are about those of
/// the picture, and none leaves the range of the 3x3 pixels around. Cubic convolution, then corrections by
/// what these means miss (iterative back-projection).
/// @throws Error{kInvalidArgument} as make_image(). All threads are used; their number does not show.
Image enlarge_twofold(const Image& image);

}  // namespace knotreel::image
