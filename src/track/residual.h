#pragma once

#include <span>
#include <vector>

#include "knotreel/image/image.h"
#include "knotreel/spline/pixel_values.h"

namespace knotreel::track {

/// Picture minus surface, channels interleaved.
std::vector<float> residual_of(const image::Image& picture, const spline::PixelValues& values,
                               std::span<const double> control);

struct Quality {
  double mec = 0;
  double psnr = 0;
};

/// @param weights by pixel; those below 1 do not count. Empty: all count.
Quality quality_of(std::span<const float> residual, std::span<const float> weights, int channels);

}  // namespace knotreel::track
