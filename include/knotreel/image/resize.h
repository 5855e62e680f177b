// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/image/image.h"

namespace knotreel::image {

/// A picture at another size: separable, with a triangle whose base is two pixels of the coarser picture.
/// Alpha is treated like the other channels.
/// @throws Error{kInvalidArgument} as make_image(). All threads are used; their number does not show.
Image resize(const Image& image, int width, int height);

}  // namespace knotreel::image
