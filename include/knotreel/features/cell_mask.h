// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "knotreel/base/pixel_box.h"

namespace knotreel::features {

/// Marks on the square cells that a picture is made of; those at its right and lower side may be smaller.
class CellMask {
 public:
  static constexpr int kSide = 8;  ///< pixels

  CellMask() = default;
  /// @param width, height of the picture, pixels. @param marked all cells, or none.
  CellMask(int width, int height, bool marked);

  int width() const { return width_; }
  int height() const { return height_; }
  int columns() const { return columns_; }
  int rows() const { return rows_; }

  bool at(int column, int row) const { return marks_[index(column, row)] != 0; }
  void set(int column, int row, bool marked) { marks_[index(column, row)] = marked ? 1 : 0; }
  bool at_pixel(int x, int y) const { return at(x / kSide, y / kSide); }

  /// With all cells that are no more than so many columns and rows away from a marked one.
  CellMask wider(int cells) const;

 private:
  std::size_t index(int column, int row) const {
    return std::size_t(row) * std::size_t(columns_) + std::size_t(column);
  }

  int width_ = 0;
  int height_ = 0;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint8_t> marks_;
};

/// What can be reached from some cells, by way of others.
struct Reached {
  CellMask cells;
  std::vector<PixelBox> boxes;  ///< around the cells of each group that hangs together, pixels
};

/// All marked cells that can be reached from those in `from`, by steps of up to `step` columns and rows from
/// a marked cell to the next, and those in `from` themselves. @param marked of the same picture as `from`.
Reached reach(const CellMask& from, const CellMask& marked, int step);

/// Windows without a common pixel that hold all boxes, with a margin around each as far as the picture goes.
/// @param margin pixels, 0 or more. @param width, height of the picture.
std::vector<PixelBox> windows_around(const std::vector<PixelBox>& boxes, int margin, int width, int height);

}  // namespace knotreel::features
