// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/changed_boxes.h"

#include <algorithm>
#include <utility>

#include "knotreel/motion/unchanged.h"

namespace knotreel::motion {

namespace {

bool meet(const PixelBox& a, const PixelBox& b) {
  return a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
}

PixelBox around(const PixelBox& a, const PixelBox& b) {
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
          std::max(a.bottom, b.bottom)};
}

/// Adds a box, and whatever it then meets to it.
void merge(PixelBox box, std::vector<PixelBox>& boxes) {
  for (std::size_t i = 0; i < boxes.size();) {
    if (!meet(box, boxes[i])) {
      ++i;
      continue;
    }
    box = around(box, boxes[i]);
    boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(i));
    i = 0;
  }
  boxes.push_back(box);
}

}  // namespace

std::vector<PixelBox> changed_boxes(std::span<const std::uint8_t> unchanged, int width, int height,
                                    int margin) {
  const int columns = (width + kCellSide - 1) / kCellSide;
  const int rows = (height + kCellSide - 1) / kCellSide;
  std::vector<PixelBox> boxes;
  for (int row = 0; row < rows; ++row) {
    const std::uint8_t* const cells = unchanged.data() + std::size_t(row) * std::size_t(columns);
    // Runs of cells that change.
    for (int column = 0; column < columns;) {
      if (cells[column]) {
        ++column;
        continue;
      }
      const int first = column;
      while (column < columns && !cells[column]) ++column;
      merge({std::max(0, first * kCellSide - margin), std::max(0, row * kCellSide - margin),
             std::min(width, column * kCellSide + margin), std::min(height, (row + 1) * kCellSide + margin)},
            boxes);
    }
  }
  return boxes;
}

}  // namespace knotreel::motion
