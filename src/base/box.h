// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "knotreel/base/vec2.h"

namespace knotreel {

/// A rectangle along the axes; at first, that of no point.
struct Box {
  Vec2 low{1e300, 1e300};
  Vec2 high{-1e300, -1e300};

  /// Makes it hold a point, too.
  void add(Vec2 p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y)};
  }
};

}  // namespace knotreel
