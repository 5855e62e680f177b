// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/background.h"

#include <algorithm>
#include <utility>

namespace knotreel::image {
namespace {

bool is_grey(const std::array<float, 3>& colour) {
  return colour[0] == colour[1] && colour[1] == colour[2];
}

}  // namespace

int channels_on(const Background& background, int channels) {
  if (!background || channels % 2 != 0) return channels;
  return channels == 2 && is_grey(*background) ? 1 : 3;
}

void put_on_background(std::vector<float>& samples, int channels, const Background& background) {
  const auto out = static_cast<std::size_t>(channels_on(background, channels));
  if (out == static_cast<std::size_t>(channels)) return;
  const std::array<float, 3>& colour = *background;
  const auto stride = static_cast<std::size_t>(channels);
  const std::size_t colours = stride - 1;
  std::vector<float> grown;  // grey that becomes colour has no room in place
  if (out > stride) grown.resize(samples.size() / stride * out);
  float* to = grown.empty() ? samples.data() : grown.data();
  for (std::size_t from = 0; from < samples.size(); from += stride) {
    const float alpha = std::clamp(samples[from + colours] / 255.0F, 0.0F, 1.0F);
    for (std::size_t c = 0; c < out; ++c)
      *to++ = alpha * samples[from + std::min(c, colours - 1)] + (1 - alpha) * colour[c];
  }
  if (grown.empty()) {
    samples.resize(samples.size() / stride * out);
  } else {
    samples = std::move(grown);
  }
}

Image on_background(Image picture, const Background& background) {
  put_on_background(picture.samples, picture.channels, background);
  picture.channels = channels_on(background, picture.channels);
  return picture;
}

}  // namespace knotreel::image
