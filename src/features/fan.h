// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/image/image.h"

namespace knotreel::features {

/// Rays from a tip part the plane into areas: two at a corner of a curve, more where curves meet.
struct Fan {
  Vec2 tip;
  std::vector<Vec2> rays;  ///< unit vectors, two or more, none twice, in the order of their angles
};

/// Shares of the unit square with that top left corner that are in the areas, from each ray to the next.
void shares_of(const Fan& fan, double left, double top, double* shares);

/// A fan, and how well one colour per area explains the pixels around its tip: the root mean square of what
/// is left over that of the differences across its rays.
struct FanFit {
  Fan fan;
  double error = 0;
};

/// A square of pixels.
struct FanWindow {
  static constexpr int kSize = 7;
  int x = 0;  ///< left column
  int y = 0;  ///< top row
};

/// The pixels that fit_fan() looks at for a fan with that tip; nothing if some are beyond the picture.
std::optional<FanWindow> fan_window(const image::Image& image, Vec2 tip);

/// The fan near `start` that explains the pixels around the tip of `start` best. Colours count by their
/// alpha. Nothing near the sides of the picture, where areas are hardly seen, or without a difference.
/// @param through  a point for each ray that it passes, a few pixels from the tip: what is around the tip
/// alone says less of angles.
std::optional<FanFit> fit_fan(const image::Image& image, const Fan& start, const std::vector<Vec2>& through);

}  // namespace knotreel::features
