// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/cell_mask.h"

#include <algorithm>
#include <utility>

#include "base/tiles_around.h"

namespace knotreel::features {
namespace {

int cells_of(int pixels) {
  return (pixels + CellMask::kSide - 1) / CellMask::kSide;
}

/// Goes from cell to cell.
class Spreading {
 public:
  Spreading(const CellMask& from, const CellMask& marked, int step)
      : from_(from), marked_(marked), step_(step), reached_(from.width(), from.height(), false) {}

  Reached run() {
    Reached result;
    for (int row = 0; row < from_.rows(); ++row) {
      for (int column = 0; column < from_.columns(); ++column) {
        if (from_.at(column, row) && !reached_.at(column, row)) result.boxes.push_back(spread(column, row));
      }
    }
    result.cells = std::move(reached_);
    return result;
  }

 private:
  struct Cell {
    int column;
    int row;
  };

  /// @return the box of the group.
  PixelBox spread(int column, int row) {
    PixelBox box{column, row, column + 1, row + 1};
    add(column, row);
    while (!open_.empty()) {
      const Cell cell = open_.back();
      open_.pop_back();
      box = around(box, {cell.column, cell.row, cell.column + 1, cell.row + 1});
      for (int r = std::max(0, cell.row - step_); r <= std::min(from_.rows() - 1, cell.row + step_); ++r) {
        for (int c = std::max(0, cell.column - step_);
             c <= std::min(from_.columns() - 1, cell.column + step_); ++c) {
          if (!reached_.at(c, r) && (marked_.at(c, r) || from_.at(c, r))) add(c, r);
        }
      }
    }
    constexpr int kSide = CellMask::kSide;
    return {kSide * box.left, kSide * box.top, std::min(from_.width(), kSide * box.right),
            std::min(from_.height(), kSide * box.bottom)};
  }

  void add(int column, int row) {
    reached_.set(column, row, true);
    open_.push_back({column, row});
  }

  const CellMask& from_;
  const CellMask& marked_;
  int step_;
  CellMask reached_;
  std::vector<Cell> open_;
};

}  // namespace

CellMask::CellMask(int width, int height, bool marked)
    : width_(width),
      height_(height),
      columns_(cells_of(width)),
      rows_(cells_of(height)),
      marks_(std::size_t(columns_) * std::size_t(rows_), marked ? 1 : 0) {}

CellMask CellMask::wider(int cells) const {
  CellMask result(width_, height_, false);
  result.marks_ = tiles_around(marks_, std::size_t(columns_), std::size_t(cells));
  return result;
}

Reached reach(const CellMask& from, const CellMask& marked, int step) {
  return Spreading(from, marked, step).run();
}

std::vector<PixelBox> windows_around(const std::vector<PixelBox>& boxes, int margin, int width, int height) {
  std::vector<PixelBox> windows;
  for (const PixelBox& box : boxes) add_apart(with_margin(box, margin, width, height), windows);
  return windows;
}

}  // namespace knotreel::features
