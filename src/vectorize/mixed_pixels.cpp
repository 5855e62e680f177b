// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/mixed_pixels.h"

#include <cstddef>

#include "knotreel/image/two_colours.h"
#include "knotreel/raster/mixed_pixels.h"

namespace knotreel::vectorize {
namespace {

// Of the weight of mixed pixels, where edges come in steps: there a pixel tells its own colour, no mixture.
constexpr double kShareOfSteps = 0.3;

bool is_stepped(const image::Image& picture, int x, int y) {
  return x > 0 && y > 0 && x + 1 < picture.width && y + 1 < picture.height &&
         image::has_two_colours(picture, x - 1, y - 1);
}

}  // namespace

fit::MixedPixels mixed_pixels(document::FrameModel model, const std::shared_ptr<const spline::Basis>& basis,
                              const image::Image& picture, double weight,
                              std::span<const std::uint8_t> tiles) {
  model.colour.resize(model.space->function_count() * static_cast<std::size_t>(model.channels));
  fit::MixedPixels mixed = raster::mixed_pixels(model, basis, tiles);
  const auto channels = static_cast<std::size_t>(picture.channels);
  const auto width = static_cast<std::size_t>(picture.width);
  for (const std::uint32_t pixel : mixed.pixels) {
    const auto x = static_cast<int>(pixel % width);
    const auto y = static_cast<int>(pixel / width);
    mixed.weights.push_back(weight * (is_stepped(picture, x, y) ? kShareOfSteps : 1.0));
    const float* const colour = &picture.samples[pixel * channels];
    mixed.colours.insert(mixed.colours.end(), colour, colour + channels);
  }
  return mixed;
}

}  // namespace knotreel::vectorize
