// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>

#include "knotreel/base/vec2.h"

namespace knotreel {

/// Height of a triangle over its longest side; 0 if all corners are one point.
inline double height_over_longest(const std::array<Vec2, 3>& t) {
  const double longest = std::max({norm(t[1] - t[0]), norm(t[2] - t[1]), norm(t[0] - t[2])});
  return longest > 0 ? 2 * signed_area(t[0], t[1], t[2]) / longest : 0;
}

}  // namespace knotreel
