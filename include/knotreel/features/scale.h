// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/features/chains.h"
#include "knotreel/image/image.h"

namespace knotreel::features {

/// Pixels of the chains per pixel of a picture: 1, or 2 if they were detected in it enlarged.
/// @throws Error{kInvalidArgument} for other sizes.
int scale_of(const FeatureChains& chains, const image::Image& picture);

}  // namespace knotreel::features
