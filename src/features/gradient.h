// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/features/detect.h"
#include "knotreel/image/image.h"

namespace knotreel::features {

/// Gradients of a picture, one value per pixel in row order; planes of channels one after the other. Refers
/// to the picture.
struct GradientField {
  const image::Image* image = nullptr;
  int width = 0;
  int height = 0;
  int origin_x = 0;  ///< where the picture lies in a larger one that it may be a window of
  int origin_y = 0;
  int whole_width = 0;  ///< of that one
  int whole_height = 0;
  std::vector<float> smooth;          ///< planes; colours times alpha: what is invisible has no edges
  std::vector<float> magnitude;       ///< of the channel that changes most
  std::vector<std::uint8_t> channel;  ///< which one that is; the first of equals

  std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
  const float* plane(int c) const { return smooth.data() + std::size_t(c) * pixels(); }

  /// Central differences of one channel. The pixel must not lie at a side of the picture.
  Vec2 inner_gradient(std::size_t i, int c) const {
    const float* s = plane(c) + i;
    return {0.5 * (double{s[1]} - double{s[-1]}), 0.5 * (double{s[width]} - double{*(s - width)})};
  }
  Vec2 inner_gradient(std::size_t i) const { return inner_gradient(i, channel[i]); }
  /// The same for all pixels.
  Vec2 gradient(int x, int y) const;
  /// Sample of the picture, colours times alpha.
  double raw(int x, int y, int c) const;
};

/// The edge runs up and down.
inline bool is_vertical(Vec2 gradient) {
  return std::abs(gradient.x) > std::abs(gradient.y);
}

/// Beyond the sides the picture goes on with the pixels at the sides.
GradientField make_gradient_field(const image::Image& image, const DetectOptions& options);

/// How many columns or rows away from a pixel there may be others that its gradient hangs on.
int reach_of_gradients(const DetectOptions& options);

}  // namespace knotreel::features
