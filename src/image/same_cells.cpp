// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/same_cells.h"

#include <algorithm>
#include <cstring>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::image {

std::vector<std::uint8_t> same_cells(const Image& a, const Image& b, int side) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels)
    throw Error(ErrorKind::kInvalidArgument, "two pictures differ in size or channels");
  check_image(a);
  check_image(b);
  const auto columns = static_cast<std::size_t>((a.width + side - 1) / side);
  const auto rows = static_cast<std::size_t>((a.height + side - 1) / side);
  std::vector<std::uint8_t> same(columns * rows, 1);
  const auto cell_size = static_cast<std::size_t>(side * a.channels);
  parallel_for(rows, [&](std::size_t row) {
    const int first = static_cast<int>(row) * side;
    for (int y = first; y < std::min(first + side, a.height); ++y) {
      const auto row_a = a.row(y);
      const auto row_b = b.row(y);
      for (std::size_t c = 0; c < columns; ++c) {
        const std::size_t from = c * cell_size;
        const std::size_t bytes = (std::min(from + cell_size, row_a.size()) - from) * sizeof(float);
        if (std::memcmp(&row_a[from], &row_b[from], bytes) != 0) same[row * columns + c] = 0;
      }
    }
  });
  return same;
}

}  // namespace knotreel::image
