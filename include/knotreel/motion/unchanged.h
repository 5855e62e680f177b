// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/base/vec2.h"
#include "knotreel/image/same_cells.h"

namespace knotreel::motion {

/// Side of the cells that a picture is compared in, pixels.
inline constexpr int kCellSide = 8;

/// Which of these cells are as they were, as image::same_cells().
inline std::vector<std::uint8_t> unchanged_cells(const image::Image& before, const image::Image& now) {
  return image::same_cells(before, now, kCellSide);
}

/// Which parts of a video have not changed for some time. Not thread safe but for const members.
class Rest {
 public:
  /// @param frames that a cell has to stay as it is, before it rests.
  explicit Rest(int frames) : frames_(frames) {}

  /// Another video, of which nothing is known.
  void start(int width, int height);
  /// The next picture. @param unchanged of unchanged_cells(), against the one before.
  void add(const std::vector<std::uint8_t>& unchanged);

  /// Whether the cell of a pixel rests.
  bool at(int x, int y) const {
    return age_[static_cast<std::size_t>((y / kCellSide) * columns_ + x / kCellSide)] == frames_;
  }

  /// Share of the cells that rest, 0 to 1.
  double share() const;

  /// Whether all cells that a box meets rest. The box may reach beyond the picture.
  bool holds(Vec2 low, Vec2 high) const;

 private:
  int frames_;
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint8_t> age_;        ///< frames, up to those that it takes
  std::vector<std::uint32_t> restless_;  ///< cells above and to the left, (columns + 1) x (rows + 1)
};

}  // namespace knotreel::motion
