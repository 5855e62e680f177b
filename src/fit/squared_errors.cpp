// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/squared_errors.h"

#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

constexpr float kHidden = 0.03F;  // weight of pixels without alpha

}  // namespace

std::vector<float> squared_errors(std::span<const float> residual, std::span<const float> weights,
                                  const image::Image& picture) {
  std::vector<float> squared(picture.pixel_count());
  const auto width = static_cast<std::size_t>(picture.width);
  const auto channels = static_cast<std::size_t>(picture.channels);
  parallel_for(static_cast<std::size_t>(picture.height), [&](std::size_t y) {
    for (std::size_t i = y * width; i < (y + 1) * width; ++i) {
      if (!weights.empty() && weights[i] < 1) continue;
      squared[i] = squared_error<float>(picture, &residual[i * channels], &picture.samples[i * channels]);
    }
  });
  return squared;
}

std::vector<float> steering_weights(const image::Image& picture, std::vector<float> weights) {
  if (!picture.has_alpha()) return weights;
  if (weights.empty()) weights.assign(picture.pixel_count(), 1);
  const auto channels = static_cast<std::size_t>(picture.channels);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const float share = seen_share(picture, &picture.samples[i * channels]);
    weights[i] *= kHidden + (1 - kHidden) * share;
  }
  return weights;
}

}  // namespace knotreel::fit
