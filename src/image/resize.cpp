// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/resize.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "knotreel/base/parallel.h"

namespace knotreel::image {
namespace {

/// Samples [first, first + weights.size()) of a line and their shares in one sample of the new line.
struct Taps {
  int first = 0;
  std::vector<float> weights;
};

std::vector<Taps> taps_of(int from, int to) {
  const double step = double(from) / to;
  const double reach = std::max(1.0, step);
  std::vector<Taps> all(static_cast<std::size_t>(to));
  for (int i = 0; i < to; ++i) {
    const double centre = (i + 0.5) * step;
    Taps& taps = all[static_cast<std::size_t>(i)];
    taps.first = std::max(0, static_cast<int>(std::floor(centre - reach + 0.5)));
    const int end = std::min(from, static_cast<int>(std::ceil(centre + reach + 0.5)));
    double sum = 0;
    for (int k = taps.first; k < end; ++k) sum += std::max(0.0, 1 - std::abs(k + 0.5 - centre) / reach);
    for (int k = taps.first; k < end; ++k) {
      const double weight = std::max(0.0, 1 - std::abs(k + 0.5 - centre) / reach);
      taps.weights.push_back(static_cast<float>(weight / sum));
    }
  }
  return all;
}

Image rows_resized(const Image& image, int height) {
  Image result = make_image(image.width, height, image.channels);
  const std::vector<Taps> taps = taps_of(image.height, height);
  parallel_for(taps.size(), [&](std::size_t y) {
    const auto out = result.row(int(y));
    for (std::size_t k = 0; k < taps[y].weights.size(); ++k) {
      const auto in = image.row(taps[y].first + int(k));
      for (std::size_t i = 0; i < out.size(); ++i) out[i] += taps[y].weights[k] * in[i];
    }
  });
  return result;
}

Image columns_resized(const Image& image, int width) {
  Image result = make_image(width, image.height, image.channels);
  const std::vector<Taps> taps = taps_of(image.width, width);
  parallel_for(std::size_t(image.height), [&](std::size_t y) {
    for (int x = 0; x < width; ++x) {
      const Taps& tap = taps[std::size_t(x)];
      for (std::size_t k = 0; k < tap.weights.size(); ++k) {
        for (int c = 0; c < image.channels; ++c) {
          result.at(x, int(y), c) += tap.weights[k] * image.at(tap.first + int(k), int(y), c);
        }
      }
    }
  });
  return result;
}

}  // namespace

Image resize(const Image& image, int width, int height) {
  check_image(image);
  return columns_resized(rows_resized(image, height), width);
}

}  // namespace knotreel::image
