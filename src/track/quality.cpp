// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/quality.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "knotreel/base/parallel.h"
#include "knotreel/fit/squared_errors.h"
#include "knotreel/raster/render.h"

namespace knotreel::track {

namespace {

constexpr std::size_t kBlock = 8192;  // pixels with a sum of their own

struct Sums {
  double length = 0;
  double squares = 0;
  std::size_t count = 0;
};

Sums sums_of(std::span<const float> residual, std::span<const float> weights, const image::Image& picture,
             std::size_t begin, std::size_t end) {
  Sums sums;
  const auto channels = static_cast<std::size_t>(picture.channels);
  for (std::size_t i = begin; i < end; ++i) {
    if (!weights.empty() && weights[i] < 1) continue;
    const auto squared =
        fit::squared_error<double>(picture, &residual[i * channels], &picture.samples[i * channels]);
    sums.length += std::sqrt(squared);
    sums.squares += squared;
    ++sums.count;
  }
  return sums;
}

}  // namespace

Quality quality_of(std::span<const float> residual, std::span<const float> weights,
                   const image::Image& picture) {
  const auto channels = static_cast<std::size_t>(picture.channels);
  const std::size_t pixels = residual.size() / channels;
  std::vector<Sums> blocks((pixels + kBlock - 1) / kBlock);
  parallel_for(blocks.size(), [&](std::size_t b) {
    blocks[b] = sums_of(residual, weights, picture, b * kBlock, std::min(pixels, (b + 1) * kBlock));
  });
  Sums sums;
  for (const Sums& block : blocks) {
    sums.length += block.length;
    sums.squares += block.squares;
    sums.count += block.count;
  }
  if (sums.count == 0) return {};
  const double n = static_cast<double>(sums.count);
  return {sums.length / n, 10 * std::log10(255.0 * 255.0 * n * static_cast<double>(channels) / sums.squares)};
}

double psnr_as_drawn(const FittedFrame& frame, const image::Image& picture) {
  std::vector<float> residual = raster::render(model_of(frame, picture.channels));
  std::transform(picture.samples.begin(), picture.samples.end(), residual.begin(), residual.begin(),
                 std::minus());
  return quality_of(residual, {}, picture).psnr;
}

}  // namespace knotreel::track
