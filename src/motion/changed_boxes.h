// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace knotreel::motion {

/// Pixels of a picture: [left, right) x [top, bottom).
struct PixelBox {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;

  int width() const { return right - left; }
  int height() const { return bottom - top; }
};

/// A few boxes without a common pixel that hold all cells that change, with a margin around each.
/// @param unchanged of unchanged_cells() for a picture of this size. @param margin pixels, 0 or more.
std::vector<PixelBox> changed_boxes(std::span<const std::uint8_t> unchanged, int width, int height,
                                    int margin);

}  // namespace knotreel::motion
