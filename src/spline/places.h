#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/base/vec2.h"

namespace knotreel::spline {

/// Pixels with places of their own in the parametric domain, instead of their centres.
class Places {
 public:
  /// @param cell_width, cell_height of a pixel. @param places row-major, or none: all at the centres.
  Places(int columns, int rows, double cell_width, double cell_height, std::span<const Vec2> places)
      : columns_(static_cast<std::size_t>(columns)),
        tile_columns_(columns_ / kTile + 1),
        cell_width_(cell_width),
        cell_height_(cell_height) {
    if (places.empty()) return;
    x_.resize(places.size());
    y_.resize(places.size());
    reach_.assign(tile_columns_ * (static_cast<std::size_t>(rows) / kTile + 1), 0);
    for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) {
      double* tiles = reach_.data() + row / kTile * tile_columns_;
      const double centre_y = (static_cast<double>(row) + 0.5) * cell_height;
      for (std::size_t column = 0; column < columns_; ++column) {
        const std::size_t i = row * columns_ + column;
        x_[i] = places[i].x;
        y_[i] = places[i].y;
        const double dx = std::abs(x_[i] - (static_cast<double>(column) + 0.5) * cell_width);
        const double dy = std::abs(y_[i] - centre_y);
        double& reach = tiles[column / kTile];
        reach = std::max({reach, dx, dy});
      }
    }
    widest_ = *std::max_element(reach_.begin(), reach_.end());
  }

  /// Places of a row of pixels.
  const double* x(std::int32_t row) const { return x_.data() + static_cast<std::size_t>(row) * columns_; }
  const double* y(std::int32_t row) const { return y_.data() + static_cast<std::size_t>(row) * columns_; }

  /// Largest distance by coordinate of any pixel from its place.
  double widest() const { return widest_; }

  /// Whether some pixel near those of the columns [begin, end) of a row is not at its centre.
  bool moved(std::int32_t row, std::int32_t begin, std::int32_t end) const {
    if (widest_ == 0 || begin >= end) return false;
    const double* tiles = reach_.data() + static_cast<std::size_t>(row) / kTile * tile_columns_;
    return std::any_of(tiles + static_cast<std::size_t>(begin) / kTile,
                       tiles + static_cast<std::size_t>(end - 1) / kTile + 1, [](double r) { return r > 0; });
  }

  /// Largest distance by coordinate of a pixel from its place, for the pixels that may lie in a box.
  double reach(Vec2 low, Vec2 high) const {
    if (widest_ == 0) return 0;
    const auto tile = [](double v, double cell, std::size_t count) {
      return std::min(count - 1, static_cast<std::size_t>(std::max(0.0, v / cell)) / kTile);
    };
    const std::size_t right = tile(high.x + widest_, cell_width_, tile_columns_);
    const std::size_t rows = reach_.size() / tile_columns_;
    const std::size_t bottom = tile(high.y + widest_, cell_height_, rows);
    double reach = 0;
    for (std::size_t v = tile(low.y - widest_, cell_height_, rows); v <= bottom; ++v) {
      for (std::size_t u = tile(low.x - widest_, cell_width_, tile_columns_); u <= right; ++u) {
        reach = std::max(reach, reach_[v * tile_columns_ + u]);
      }
    }
    return reach;
  }

 private:
  static constexpr std::size_t kTile = 8;

  std::size_t columns_;
  std::size_t tile_columns_;
  double cell_width_;
  double cell_height_;
  std::vector<double> x_;
  std::vector<double> y_;
  std::vector<double> reach_;  ///< by tiles of pixels
  double widest_ = 0;
};

}  // namespace knotreel::spline
