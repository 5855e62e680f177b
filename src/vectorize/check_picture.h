// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/image/image.h"

namespace knotreel::vectorize {

/// @throws Error{kInvalidArgument} if it has no pixels, or samples that are not finite or beyond
/// kLargestSample.
void check_picture(const image::Image& picture);

}  // namespace knotreel::vectorize
