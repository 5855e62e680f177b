#pragma once

#include <cstddef>

namespace knotreel::raster {

/// Pixels [row_begin, row_end) x [column_begin, column_end) of the grid that is drawn, and where they go:
/// row-major, channels interleaved.
struct Part {
  int row_begin;
  int row_end;
  int column_begin;
  int column_end;
  std::size_t channels;
  float* out;

  bool contains(int x, int y) const {
    return y >= row_begin && y < row_end && x >= column_begin && x < column_end;
  }

  float* at(int x, int y) const {
    const auto columns = static_cast<std::size_t>(column_end - column_begin);
    const std::size_t pixel =
        static_cast<std::size_t>(y - row_begin) * columns + static_cast<std::size_t>(x - column_begin);
    return out + pixel * channels;
  }
};

}  // namespace knotreel::raster
