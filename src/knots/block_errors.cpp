// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/block_errors.h"

#include <algorithm>

namespace knotreel::knots {

std::size_t keep_worst_blocks(std::span<float> squared_errors, int width, int height, double bound) {
  const auto row = [&](int x, int y) {
    return squared_errors.begin() + std::ptrdiff_t{y} * width + std::ptrdiff_t{x};
  };
  std::size_t worst = 0;
  for (int top = 0; top < height; top += kBlockSide) {
    const int bottom = std::min(top + kBlockSide, height);
    for (int left = 0; left < width; left += kBlockSide) {
      const int columns = std::min(kBlockSide, width - left);
      double sum = 0;
      for (int y = top; y < bottom; ++y)
        std::for_each_n(row(left, y), columns, [&](float e) { sum += static_cast<double>(e); });
      if (sum > bound * bound * columns * (bottom - top)) {
        ++worst;
        continue;
      }
      for (int y = top; y < bottom; ++y) std::fill_n(row(left, y), columns, 0.0f);
    }
  }
  return worst;
}

}  // namespace knotreel::knots
