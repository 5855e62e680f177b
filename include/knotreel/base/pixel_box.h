// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

namespace knotreel {

/// Pixels of a picture: [left, right) x [top, bottom).
struct PixelBox {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;

  int width() const { return right - left; }
  int height() const { return bottom - top; }
};

/// The smallest box that holds both.
PixelBox around(const PixelBox& a, const PixelBox& b);

/// With a margin around it, as far as the picture goes.
/// @param margin pixels, 0 or more. @param width, height of the picture.
PixelBox with_margin(const PixelBox& box, int margin, int width, int height);

/// Adds a box to others without a common pixel, as one with all that it then meets.
void add_apart(PixelBox box, std::vector<PixelBox>& boxes);

}  // namespace knotreel
