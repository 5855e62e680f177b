// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/changed_boxes.h"

#include "knotreel/motion/unchanged.h"

namespace knotreel::motion {

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
      const PixelBox cell_run{first * kCellSide, row * kCellSide, column * kCellSide, (row + 1) * kCellSide};
      add_apart(with_margin(cell_run, margin, width, height), boxes);
    }
  }
  return boxes;
}

}  // namespace knotreel::motion
