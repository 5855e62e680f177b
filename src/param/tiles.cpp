// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/tiles.h"

#include <algorithm>

namespace knotreel::param {

bool Tiles::any() const {
  return std::any_of(chosen_.begin(), chosen_.end(), [](std::uint8_t tile) { return tile != 0; });
}

void Tiles::add(const Tiles& others) {
  for (std::size_t i = 0; i < chosen_.size(); ++i) chosen_[i] |= others.chosen_[i];
}

Tiles Tiles::grown(int tiles) const {
  Tiles result = *this;
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      if (!has(x, y)) continue;
      for (int v = std::max(0, y - tiles); v <= std::min(rows_ - 1, y + tiles); ++v) {
        for (int u = std::max(0, x - tiles); u <= std::min(columns_ - 1, x + tiles); ++u) result.add(u, v);
      }
    }
  }
  return result;
}

Tiles Tiles::halved(int width, int height) const {
  Tiles result(width, height);
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      if (has(x, y)) result.add(x / 2, y / 2);
    }
  }
  return result;
}

}  // namespace knotreel::param
