// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "knotreel/image/image.h"

namespace knotreel::test {

/// Independent samples, multiples of 1/257 in [0,255]: exact in 16 bits.
inline image::Image random_picture(int width, int height, int channels, unsigned seed) {
  image::Image image = image::make_image(width, height, channels);
  std::mt19937 random(seed);
  for (float& sample : image.samples) sample = float(random() % 65536) / 257.0F;
  return image;
}

/// Independent whole samples in 0..255: exact in 8 bits.
inline image::Image random_8bit_picture(int width, int height, int channels, unsigned seed) {
  image::Image image = image::make_image(width, height, channels);
  std::mt19937 random(seed);
  for (float& sample : image.samples) sample = float(random() % 256);
  return image;
}

/// A sample through the filter of document::FrameModel::edge_softness, by the definition: (s, 1 - 2 s, s)
/// along both axes, over the picture with its border pixels repeated.
inline double softened(const image::Image& picture, int x, int y, int channel, double s) {
  double sum = 0;
  for (int v = -1; v <= 1; ++v) {
    for (int u = -1; u <= 1; ++u) {
      const auto sample = double{picture.at(std::clamp(x + u, 0, picture.width - 1),
                                            std::clamp(y + v, 0, picture.height - 1), channel)};
      sum += (u == 0 ? 1 - 2 * s : s) * (v == 0 ? 1 - 2 * s : s) * sample;
    }
  }
  return sum;
}

/// The whole picture through that filter.
inline image::Image softened(const image::Image& picture, double s) {
  image::Image soft = picture;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      for (int c = 0; c < picture.channels; ++c) soft.at(x, y, c) = float(softened(picture, x, y, c, s));
  return soft;
}

/// Largest difference between samples; infinite if the shapes differ.
inline double largest_difference(const image::Image& a, const image::Image& b) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels) return INFINITY;
  double largest = 0;
  for (std::size_t i = 0; i < a.samples.size(); ++i) {
    largest = std::max(largest, std::abs(double{a.samples[i]} - double{b.samples[i]}));
  }
  return largest;
}

}  // namespace knotreel::test
