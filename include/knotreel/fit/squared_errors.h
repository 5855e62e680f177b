// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "knotreel/image/image.h"

namespace knotreel::fit {

/// What the colour errors of a pixel count: 0 where alpha hides them, to 1; errors of alpha itself always
/// count.
/// @param pixel of the picture, with all its channels.
inline float seen_share(const image::Image& picture, const float* pixel) {
  return picture.has_alpha() ? std::clamp(pixel[picture.channels - 1] / 255, 0.0F, 1.0F) : 1.0F;
}

/// Summed over the channels of a pixel.
/// @tparam Value what to add up in. @param residual of the pixel. @param pixel of the picture.
template <class Value>
Value squared_error(const image::Image& picture, const float* residual, const float* pixel) {
  const float share = seen_share(picture, pixel);
  Value sum = 0;
  for (int c = 0; c < picture.channels; ++c) {
    const auto d = static_cast<Value>(residual[c] * (c < picture.colour_channels() ? share : 1.0F));
    sum += d * d;
  }
  return sum;
}

/// Of a residual, by pixel; 0 for pixels that do not count, as in MEC and PSNR.
/// @param weights by pixel; those below 1 do not count. Empty: all count.
/// Safe to call from several threads; same bits for any number of threads.
std::vector<float> squared_errors(std::span<const float> residual, std::span<const float> weights,
                                  const image::Image& picture);

/// What pixels count where knots are put before anything is fitted: little where alpha is 0, whose colours
/// nobody sees; not nothing, since alpha has errors there, too.
/// @param weights by pixel to begin with, or empty: 1. @return them, as they are for pictures without alpha.
std::vector<float> steering_weights(const image::Image& picture, std::vector<float> weights);

}  // namespace knotreel::fit
