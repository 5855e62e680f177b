// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/tiles_around.h"

#include <algorithm>

namespace knotreel {

std::vector<std::uint8_t> tiles_around(std::span<const std::uint8_t> flags, std::size_t columns,
                                       std::size_t distance) {
  std::vector<std::uint8_t> around(flags.size(), 0);
  for (std::size_t t = 0; t < flags.size(); ++t) {
    if (!flags[t]) continue;
    const std::size_t row = t / columns;
    const std::size_t column = t % columns;
    const std::size_t left = column - std::min(column, distance);
    const std::size_t right = std::min(columns, column + distance + 1);
    for (std::size_t y = row - std::min(row, distance);
         y < std::min(flags.size() / columns, row + distance + 1); ++y)
      std::fill(&around[y * columns] + left, &around[y * columns] + right, std::uint8_t{1});
  }
  return around;
}

}  // namespace knotreel
