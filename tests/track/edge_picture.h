// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>

#include "knotreel/image/image.h"

namespace knotreel::track {

/// Dark at the left and bright at the right of a slanted edge, which crosses the middle row at x.
inline image::Image edge_at(double x) {
  image::Image image = image::make_image(96, 64, 1);
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      const double across = (i + 0.5 - x + 0.3 * (j + 0.5 - 32)) / std::hypot(1.0, 0.3);
      image.at(i, j, 0) = static_cast<float>(50 + 150 * std::clamp(across + 0.5, 0.0, 1.0));
    }
  }
  return image;
}

}  // namespace knotreel::track
