// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/captions.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "knotreel/base/parallel.h"

namespace knotreel::features {

namespace {

constexpr float kAnyStep = 50;  // levels
constexpr float kSharpStep = 128;
constexpr int kCell = 16;  // pixels
constexpr std::size_t kSharpEachWay = 6;
constexpr double kSharpShare = 0.3;        // of the steps of a cell
constexpr double kMostSteps = 0.75;        // of its pixels: noise has more
constexpr double kCaptionShare = 0.01;     // of the cells
constexpr double kMostCaptionShare = 0.4;  // screen tone and dithered pictures have more

/// Steps from a pixel to the next along the row, and along the column.
struct Steps {
  std::size_t pixels = 0;
  std::size_t any = 0;  ///< one of them is large
  std::size_t sharp = 0;
  std::size_t sharp_along = 0;
  std::size_t sharp_across = 0;

  bool are_of_captions() const {
    return sharp_along >= kSharpEachWay && sharp_across >= kSharpEachWay &&
           static_cast<double>(sharp) >= kSharpShare * static_cast<double>(any) &&
           static_cast<double>(any) <= kMostSteps * static_cast<double>(pixels);
  }
};

const float* pixel_at(const image::Image& image, int x, int y) {
  return image.row(y).data() + static_cast<std::size_t>(x) * static_cast<std::size_t>(image.channels);
}

/// Largest difference of a colour.
float step(const float* pixel, const float* next, std::size_t colours) {
  float most = 0;
  for (std::size_t c = 0; c < colours; ++c) most = std::max(most, std::abs(pixel[c] - next[c]));
  return most;
}

/// Whether a sample of a cell has a sharp step along the row: most cells of films have none, and need not be
/// looked at any further.
bool may_have_captions(const image::Image& image, int left, int top) {
  const int pixels = std::min(kCell, image.width - 1 - left);
  int sharp = 0;
  for (int y = top; y < std::min(top + kCell, image.height - 1); ++y) {
    const float* at = pixel_at(image, left, y);
    for (int i = 0; i < pixels * image.channels; ++i)
      sharp += std::abs(at[i] - at[i + image.channels]) > kSharpStep ? 1 : 0;
  }
  return sharp > 0;
}

Steps steps_of(const image::Image& image, int left, int top) {
  const auto colours = static_cast<std::size_t>(image.colour_channels());
  const auto pixel = static_cast<std::size_t>(image.channels);
  Steps steps;
  for (int y = top; y < std::min(top + kCell, image.height - 1); ++y) {
    const float* at = pixel_at(image, left, y);
    for (int x = left; x < std::min(left + kCell, image.width - 1); ++x, at += pixel) {
      const float along = step(at, at + pixel, colours);
      const float across = step(at, at + image.row_size(), colours);
      ++steps.pixels;
      if (std::max(along, across) > kAnyStep) ++steps.any;
      if (std::max(along, across) > kSharpStep) ++steps.sharp;
      if (along > kSharpStep) ++steps.sharp_along;
      if (across > kSharpStep) ++steps.sharp_across;
    }
  }
  return steps;
}

}  // namespace

std::size_t caption_pixels(const image::Image& image) {
  struct Count {
    std::size_t cells = 0;
    std::size_t pixels = 0;
  };
  const auto columns = static_cast<std::size_t>((image.width + kCell - 1) / kCell);
  std::vector<Count> rows(static_cast<std::size_t>((image.height + kCell - 1) / kCell));
  parallel_for(rows.size(), [&](std::size_t row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const int left = kCell * static_cast<int>(column), top = kCell * static_cast<int>(row);
      if (!may_have_captions(image, left, top)) continue;
      const Steps steps = steps_of(image, left, top);
      if (!steps.are_of_captions()) continue;
      ++rows[row].cells;
      rows[row].pixels += steps.any;
    }
  });
  const Count all = std::accumulate(rows.begin(), rows.end(), Count(), [](const Count& a, const Count& b) {
    return Count{a.cells + b.cells, a.pixels + b.pixels};
  });
  const double share = static_cast<double>(all.cells) / static_cast<double>(columns * rows.size());
  return share < kCaptionShare || share > kMostCaptionShare ? 0 : all.pixels;
}

}  // namespace knotreel::features
