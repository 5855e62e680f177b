// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/debug/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace knotreel::cli::debug {
namespace {

constexpr double kMostLevels = 64;
constexpr Colour kPaper{24, 24, 28};
constexpr Colour kInk{225, 225, 225};

// Evenly spaced; lightness rises all the way, so the picture reads without colours too.
constexpr std::array<Colour, 9> kHeat{{{0, 0, 4},
                                       {31, 12, 72},
                                       {85, 15, 109},
                                       {136, 34, 106},
                                       {186, 54, 85},
                                       {227, 89, 51},
                                       {249, 140, 10},
                                       {249, 201, 50},
                                       {252, 255, 240}}};

Colour heat(double levels) {
  const double at = std::sqrt(std::clamp(levels / kMostLevels, 0.0, 1.0)) * (kHeat.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(at), kHeat.size() - 2);
  return mix(kHeat[below], kHeat[below + 1], at - static_cast<double>(below));
}

/// A sample as it is seen on white paper: colours that alpha hides are no errors.
double seen(const image::Image& image, int x, int y, int channel) {
  const auto sample = [&](int c) { return double(std::clamp(image.at(x, y, c), 0.0F, 255.0F)); };
  const double alpha = image.has_alpha() ? sample(image.channels - 1) / 255 : 1;
  return 255 + alpha * (sample(channel) - 255);
}

double error(const image::Image& a, const image::Image& b, int x, int y) {
  double squared = 0;
  for (int c = 0; c < a.colour_channels(); ++c) {
    const double d = seen(a, x, y, c) - seen(b, x, y, c);
    squared += d * d;
  }
  return std::sqrt(squared);
}

/// Colours with their levels; left out where the picture is too small.
void draw_legend(Canvas& canvas, int top) {
  constexpr int kMargin = 16;
  const int length = std::min(canvas.width() - 3 * kMargin, 640);
  if (length < 160) return;
  const auto column = [&](double levels) {
    return kMargin + static_cast<int>(std::lround(std::sqrt(levels / kMostLevels) * length));
  };
  for (int x = 0; x < length; ++x) {
    const double share = (x + 0.5) / length;
    canvas.box(kMargin + x, top + 8, 1, 16, heat(share * share * kMostLevels));
  }
  for (const int levels : {0, 1, 2, 4, 8, 16, 32, 64}) {
    const std::string text = std::to_string(levels);
    canvas.box(column(levels), top + 24, 1, 5, kInk);
    canvas.number(column(levels) - 5 * static_cast<int>(text.size()), top + 31, text, 2, kInk);
  }
}

}  // namespace

Canvas heat_map(const image::Image& picture, const image::Image& rendering) {
  const int scale = std::max(1, debug_scale(picture.width, picture.height) / 2);
  constexpr int kLegendHeight = 52;
  Canvas canvas(picture.width, picture.height, scale, kPaper, kLegendHeight);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) canvas.pixel(x, y, heat(error(picture, rendering, x, y)));
  }
  draw_legend(canvas, picture.height * scale);
  return canvas;
}

}  // namespace knotreel::cli::debug
