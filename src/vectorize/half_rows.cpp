// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/half_rows.h"

#include "knotreel/base/parallel.h"

namespace knotreel::vectorize {

PixelData half_rows(const fit::Pixels& pixels) {
  const image::Image& image = *pixels.image;
  const auto width = static_cast<std::size_t>(image.width);
  const auto channels = static_cast<std::size_t>(image.channels);
  PixelData half;
  half.image = image::make_image(image.width, image.height / 2, image.channels);
  const std::size_t count = half.image.pixel_count();
  if (!pixels.weights.empty()) half.weights.resize(count);
  if (!pixels.places.empty()) half.places.resize(count);
  const auto pair = [&](std::size_t i) {
    const std::size_t x = i % width;
    const std::size_t y = 2 * (i / width);
    const std::size_t upper = y * width + x;
    const std::size_t lower = upper + width;
    const auto weight = [&](std::size_t p) { return pixels.weights.empty() ? 1.0F : pixels.weights[p]; };
    const auto ordinary = [&](std::size_t p, std::size_t row) {
      const Vec2 centre{static_cast<double>(x) + 0.5, static_cast<double>(row) + 0.5};
      return weight(p) == 1.0F && (pixels.places.empty() || pixels.places[p] == centre);
    };
    float* out = half.image.samples.data() + i * channels;
    const float* a = image.samples.data() + upper * channels;
    const float* b = image.samples.data() + lower * channels;
    if (ordinary(upper, y) && ordinary(lower, y + 1)) {
      for (std::size_t c = 0; c < channels; ++c) out[c] = 0.5F * (a[c] + b[c]);
      if (!half.weights.empty()) half.weights[i] = 1;
      if (!half.places.empty()) half.places[i] = {static_cast<double>(x) + 0.5, static_cast<double>(y) + 1};
      return;
    }
    const std::size_t better = weight(lower) > weight(upper) ? lower : upper;
    for (std::size_t c = 0; c < channels; ++c) out[c] = better == upper ? a[c] : b[c];
    if (!half.weights.empty()) half.weights[i] = weight(better);
    if (!half.places.empty()) half.places[i] = pixels.places[better];
  };
  parallel_for(count / width, [&](std::size_t row) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) pair(i);
  });
  return half;
}

}  // namespace knotreel::vectorize
