// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "knotreel/image/metrics.h"
#include "knotreel/raster/render.h"
#include "knotreel/vectorize/vectorize.h"

/// Pictures to vectorize, drawn with eight by eight samples per pixel.
namespace knotreel::vectorize {

using Colour = std::array<double, 4>;

inline image::Image draw(int width, int height, int channels,
                         const std::function<Colour(double, double)>& at) {
  image::Image image = image::make_image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Colour sum{};
      for (int s = 0; s < 64; ++s) {
        const Colour c = at(x + (s % 8 + 0.5) / 8, y + (s / 8 + 0.5) / 8);
        for (std::size_t k = 0; k < 4; ++k) sum[k] += c[k] / 64;
      }
      for (int k = 0; k < channels; ++k)
        image.at(x, y, k) = static_cast<float>(sum[static_cast<std::size_t>(k)]);
    }
  }
  return image;
}

/// A shaded disc and a shaded band on a shaded ground: smooth but for sharp contours.
inline image::Image still_life(int width, int height, int channels = 3) {
  const double r = 0.3 * std::min(width, height);
  return draw(width, height, channels, [=](double x, double y) -> Colour {
    const double u = x / width;
    const double v = y / height;
    if (std::hypot(x - 0.4 * width, y - 0.45 * height) < r)
      return {220 - 60 * u, 90 + 50 * v, 60 + 40 * u * v, 230};
    if (std::abs(x - 0.75 * width - 0.15 * (y - 0.5 * height)) < 0.06 * width)
      return {40, 60 + 80 * v, 160, 120};
    return {90 + 60 * u, 140 - 40 * v, 120 + 50 * std::sin(3 * u + 2 * v), 200};
  });
}

inline image::Image rendered(const document::FrameModel& model, const raster::RenderOptions& options = {}) {
  const raster::Renderer size(model, options);
  return {size.width(), size.height(), size.channels(), raster::render(model, options)};
}

inline double psnr(const image::Image& picture, const document::FrameModel& model) {
  return image::compare_images(picture, rendered(model)).psnr;
}

}  // namespace knotreel::vectorize
