// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/base/pixel_box.h"

#include <algorithm>
#include <cstddef>

namespace knotreel {

namespace {

bool meet(const PixelBox& a, const PixelBox& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

}  // namespace

PixelBox around(const PixelBox& a, const PixelBox& b) {
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
          std::max(a.bottom, b.bottom)};
}

PixelBox with_margin(const PixelBox& box, int margin, int width, int height) {
  return {std::max(0, box.left - margin), std::max(0, box.top - margin), std::min(width, box.right + margin),
          std::min(height, box.bottom + margin)};
}

void add_apart(PixelBox box, std::vector<PixelBox>& boxes) {
  for (std::size_t i = 0; i < boxes.size();) {
    if (!meet(box, boxes[i])) {
      ++i;
      continue;
    }
    box = around(box, boxes[i]);
    boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;  // the larger one may meet those before
  }
  boxes.push_back(box);
}

}  // namespace knotreel
