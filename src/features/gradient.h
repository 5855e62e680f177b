#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/features/detect.h"
#include "knotreel/image/image.h"

namespace knotreel::features {

/// Gradients of a picture, one value per pixel in row order; planes of channels one after the other.
struct GradientField {
  int width = 0;
  int height = 0;
  int channels = 0;
  std::vector<float> raw;     ///< planes; colours times alpha, so that what is invisible has no edges
  std::vector<float> smooth;  ///< planes
  std::vector<float> gx;      ///< central differences of the smoothed channel that changes most
  std::vector<float> gy;
  std::vector<float> magnitude;
  std::vector<std::uint8_t> channel;  ///< which one that is; the first of equals

  std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }
  std::size_t at(int x, int y) const { return std::size_t(y) * std::size_t(width) + std::size_t(x); }
  /// The edge runs up and down there.
  bool vertical(std::size_t i) const { return (gx[i] < 0 ? -gx[i] : gx[i]) > (gy[i] < 0 ? -gy[i] : gy[i]); }
  /// Gradient of one channel. The pixel must not lie at a side of the picture.
  Vec2 gradient(std::size_t i, int c) const {
    const float* s = smooth.data() + std::size_t(c) * pixels() + i;
    return {0.5 * (double{s[1]} - double{s[-1]}), 0.5 * (double{s[width]} - double{*(s - width)})};
  }
};

/// Beyond the sides the picture goes on with the pixels at the sides.
GradientField make_gradient_field(const image::Image& image, const DetectOptions& options);

}  // namespace knotreel::features
