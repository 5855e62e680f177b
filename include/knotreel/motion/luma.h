// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/image/image.h"

namespace knotreel::motion {

/// The brightness of a picture in 8 bits: what motion is looked for in. Row-major, one value per pixel.
struct Luma {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> v;
};

/// Luma of a picture (Rec. 601 weights; grey is its own luma), rounded to the nearest level and clamped to
/// 0..255. With alpha, from 64 for black to 255, times alpha: the outline of any shape is an edge, even of a
/// black one, whatever colours are hidden outside (decision 34).
/// @throws Error{kInvalidArgument} if the picture is empty.
/// All threads are used; the result does not depend on their number.
Luma luma_of(const image::Image& picture);

}  // namespace knotreel::motion
