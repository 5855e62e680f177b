#pragma once

#include <span>

namespace knotreel::track {

struct Quality {
  double mec = 0;
  double psnr = 0;
};

/// @param weights by pixel; those below 1 do not count. Empty: all count.
Quality quality_of(std::span<const float> residual, std::span<const float> weights, int channels);

}  // namespace knotreel::track
