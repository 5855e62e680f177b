// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/local_error.h"

#include <algorithm>
#include <cmath>

#include "knotreel/base/parallel.h"

namespace knotreel::track {

namespace {

constexpr int kErrorTile = 8;  // pixels

}  // namespace

std::vector<double> local_errors(const spline::SplineSpace& space, std::span<const float> residual, int width,
                                 int height, int channels) {
  const auto columns = static_cast<std::size_t>((width + kErrorTile - 1) / kErrorTile);
  const auto rows = static_cast<std::size_t>((height + kErrorTile - 1) / kErrorTile);
  const std::size_t row_size = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
  const std::size_t tile_size = static_cast<std::size_t>(kErrorTile * channels);
  std::vector<double> means(columns * rows);
  parallel_for(rows, [&](std::size_t row) {
    const std::size_t first = row * kErrorTile;
    const std::size_t last = std::min(first + kErrorTile, static_cast<std::size_t>(height));
    for (std::size_t t = 0; t < columns; ++t) {
      const std::size_t from = t * tile_size;
      const std::size_t to = std::min(from + tile_size, row_size);
      float sum = 0;
      for (std::size_t y = first; y < last; ++y) {
        for (std::size_t i = y * row_size + from; i < y * row_size + to; ++i) sum += std::abs(residual[i]);
      }
      means[row * columns + t] = static_cast<double>(sum) / static_cast<double>((last - first) * (to - from));
    }
  });
  const auto tile = [](double at, std::size_t count) {
    return std::min(static_cast<std::size_t>(std::max(0.0, at / kErrorTile)), count - 1);
  };
  std::vector<double> result(space.function_count());
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    const Vec2 site = space.greville(f);
    result[f] = means[tile(site.y, rows) * columns + tile(site.x, columns)];
  }
  return result;
}

}  // namespace knotreel::track
