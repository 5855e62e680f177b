// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace knotreel::param {

/// Some of the square tiles of a grid of cells.
class Tiles {
 public:
  static constexpr int kSide = 32;  ///< cells

  Tiles() = default;
  /// None of them. @param width, height of the grid, in cells.
  Tiles(int width, int height)
      : columns_((width + kSide - 1) / kSide),
        rows_((height + kSide - 1) / kSide),
        chosen_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0) {}

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  std::size_t count() const { return chosen_.size(); }
  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  bool has(int column, int row) const { return chosen_[index(column, row)] != 0; }
  bool has_cell(int x, int y) const { return has(x / kSide, y / kSide); }
  bool any() const;

  void add(int column, int row) { chosen_[index(column, row)] = 1; }
  void add_cell(int x, int y) { add(x / kSide, y / kSide); }
  void add(const Tiles& others);
  void add_all() { chosen_.assign(chosen_.size(), 1); }

  /// These, and all within so many tiles.
  Tiles grown(int tiles) const;

  /// The tiles of a grid of half the size that any of these lie in.
  /// @param width, height of that grid, in cells.
  Tiles halved(int width, int height) const;

 private:
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint8_t> chosen_;
};

}  // namespace knotreel::param
