// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/image/image.h"
#include "knotreel/motion/flow.h"
#include "knotreel/motion/luma.h"

namespace knotreel::motion {

/// The other picture seen from the place of this one: `to` sampled at p + flow(p) for every pixel p of the
/// flow, bilinear, continued by its border.
/// @param to the picture that `flow` leads to, of the size of the flow.
/// @return a picture of the same size and channels; luma is rounded.
/// @throws Error{kInvalidArgument} if the sizes differ.
/// All threads are used; the result does not depend on their number.
image::Image warp(const image::Image& to, const Flow& flow);
Luma warp(const Luma& to, const Flow& flow);

}  // namespace knotreel::motion
