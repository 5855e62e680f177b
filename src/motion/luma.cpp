// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/luma.h"

#include <algorithm>

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"
#include "motion/check_sizes.h"

namespace knotreel::motion {
namespace {

std::uint8_t to_8bit(float value) {
  return std::uint8_t(std::clamp(value, 0.0F, 255.0F) + 0.5F);
}

KNOTREEL_MULTIVERSION void grey_row(const float* in, std::size_t stride, std::uint8_t* out, std::size_t n) {
  for (std::size_t x = 0; x < n; ++x) out[x] = to_8bit(in[x * stride]);
}

KNOTREEL_MULTIVERSION void colour_row(const float* in, std::size_t stride, std::uint8_t* out, std::size_t n) {
  for (std::size_t x = 0; x < n; ++x) {
    const float* p = in + x * stride;
    out[x] = to_8bit(0.299F * p[0] + 0.587F * p[1] + 0.114F * p[2]);
  }
}

/// By alpha: where there is nothing, it is darker than black.
void darken(const float* alpha, std::size_t stride, std::uint8_t* luma, std::size_t n) {
  constexpr float kBlack = 64;
  for (std::size_t x = 0; x < n; ++x) {
    const float seen = kBlack + (1 - kBlack / 255) * float(luma[x]);
    luma[x] = to_8bit(std::clamp(alpha[x * stride] / 255, 0.0F, 1.0F) * seen);
  }
}

}  // namespace

Luma luma_of(const image::Image& picture) {
  check_sizes(picture, picture);
  Luma luma{picture.width, picture.height, std::vector<std::uint8_t>(picture.pixel_count())};
  const auto convert = picture.colour_channels() == 1 ? grey_row : colour_row;
  const auto width = std::size_t(picture.width);
  parallel_for(std::size_t(picture.height), [&](std::size_t y) {
    const auto stride = std::size_t(picture.channels);
    const float* in = picture.row(int(y)).data();
    std::uint8_t* out = luma.v.data() + y * width;
    convert(in, stride, out, width);
    if (picture.has_alpha()) darken(in + stride - 1, stride, out, width);
  });
  return luma;
}

}  // namespace knotreel::motion
