// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "knotreel/base/vec2.h"
#include "knotreel/fit/mixed_pixels.h"
#include "knotreel/image/image.h"

namespace knotreel::fit {

/// What a surface is fitted to: a picture, with the place of each pixel in the parametric domain. Does not
/// own what it points to.
struct Pixels {
  const image::Image* image = nullptr;
  std::span<const float> weights = {};  ///< of the pixels, row-major, 0 or more; empty: all 1
  std::span<const Vec2> places = {};    ///< in the parametric domain, row-major; empty: the pixel centres
  const MixedPixels* mixed = nullptr;   ///< looked at besides; or null: none
};

}  // namespace knotreel::fit
