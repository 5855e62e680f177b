// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace knotreel::raster {

/// Pixels [row_begin, row_end) x [column_begin, column_end) of the grid that is drawn.
struct Region {
  int row_begin;
  int row_end;
  int column_begin;
  int column_end;

  std::size_t columns() const { return static_cast<std::size_t>(column_end - column_begin); }
  std::size_t pixel_count() const { return columns() * static_cast<std::size_t>(row_end - row_begin); }

  bool contains(int x, int y) const {
    return y >= row_begin && y < row_end && x >= column_begin && x < column_end;
  }

  /// Of a pixel in it, row by row.
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - row_begin) * columns() + static_cast<std::size_t>(x - column_begin);
  }
};

/// A region, and where its pixels go: row-major, channels interleaved.
struct Part : Region {
  std::size_t channels;
  float* out;

  float* at(int x, int y) const { return out + index(x, y) * channels; }
};

}  // namespace knotreel::raster
