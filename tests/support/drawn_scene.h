// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "knotreel/image/image.h"

namespace knotreel::test {

/// A drawing: a disk before a box, flat colours, antialiased by 4 x 4 samples per pixel.
inline image::Image drawing(double x, double y, double box_x = 52) {
  image::Image image = image::make_image(120, 90, 3);
  constexpr int kSamples = 4;
  const double ground[] = {240, 236, 220}, box[] = {40, 90, 160}, disk[] = {220, 60, 40};
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      double sum[3] = {};
      for (int s = 0; s < kSamples * kSamples; ++s) {
        const double u = i + (s % kSamples + 0.5) / kSamples;
        const double v = j + (s / kSamples + 0.5) / kSamples;
        const bool in_disk = std::hypot(u - x, v - y) < 20;
        const bool in_box = u > box_x && u < box_x + 50.3 && v > 30.2 && v < 70.7;
        for (int c = 0; c < 3; ++c) sum[c] += in_disk ? disk[c] : in_box ? box[c] : ground[c];
      }
      for (int c = 0; c < 3; ++c) image.at(i, j, c) = static_cast<float>(sum[c] / (kSamples * kSamples));
    }
  }
  return image;
}

/// The disk moves before the box, which moves the other way.
inline std::vector<image::Image> drawn_clip(int frames) {
  std::vector<image::Image> pictures;
  for (int i = 0; i < frames; ++i) pictures.push_back(drawing(34 + 1.7 * i, 40 + 0.6 * i, 52 - 0.4 * i));
  return pictures;
}

}  // namespace knotreel::test
