// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "knotreel/spline/basis.h"

namespace knotreel::spline {

/// The colours of a surface at the pixels of a picture of its size, for whoever draws what was fitted.
struct PixelSurface {
  std::shared_ptr<const Basis> basis;
  std::vector<float> colours;  ///< row-major, channels interleaved, scale 0..255, not clamped
};

}  // namespace knotreel::spline
