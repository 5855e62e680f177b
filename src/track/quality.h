// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "knotreel/image/image.h"
#include "track/fitted_frame.h"

namespace knotreel::track {

struct Quality {
  double mec = 0;
  double psnr = 0;
};

/// Colours count by their alpha.
/// @param weights by pixel; those below 1 do not count. Empty: all count.
Quality quality_of(std::span<const float> residual, std::span<const float> weights,
                   const image::Image& picture);

/// PSNR of what is drawn, edges included, which in drawings are most of what there is to see.
double psnr_as_drawn(const FittedFrame& frame, const image::Image& picture);

}  // namespace knotreel::track
