// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/tiles.h"

#include <algorithm>

#include "base/tiles_around.h"

namespace knotreel::param {

bool Tiles::any() const {
  return std::any_of(chosen_.begin(), chosen_.end(), [](std::uint8_t tile) { return tile != 0; });
}

void Tiles::add(const Tiles& others) {
  for (std::size_t i = 0; i < chosen_.size(); ++i) chosen_[i] |= others.chosen_[i];
}

Tiles Tiles::grown(int tiles) const {
  Tiles result = *this;
  result.chosen_ = tiles_around(chosen_, static_cast<std::size_t>(columns_), static_cast<std::size_t>(tiles));
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
