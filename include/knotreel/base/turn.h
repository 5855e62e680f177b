// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/vec2.h"

namespace knotreel {

/// How a picture is shown: turned by whole quarters, and mirrored if need be.
struct Turn {
  /// Of a step to the right, and of one down, in the picture: where it leads in what is shown.
  int right_x = 1, right_y = 0;
  int down_x = 0, down_y = 1;

  /// Whether it is shown as it is stored.
  bool is_none() const { return right_x == 1 && down_y == 1; }
  /// Whether what is shown is as wide as the picture is high.
  bool swaps_sides() const { return right_x == 0; }
  /// Where the origin of the picture is shown. @param right, bottom  the far sides of what is shown.
  Vec2 origin(double right, double bottom) const {
    return {right_x < 0 || down_x < 0 ? right : 0, right_y < 0 || down_y < 0 ? bottom : 0};
  }
};

}  // namespace knotreel
