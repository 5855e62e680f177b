// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "knotreel/base/vec2.h"

namespace knotreel::param {

/// Sign of signed_area(a, b, c), or 0 where rounding leaves it open. The bound is that of Shewchuk's filter
/// [Shewchuk97]; instead of going on in exact arithmetic, the callers take an open sign as a contact.
inline int orientation(Vec2 a, Vec2 b, Vec2 c) {
  const double left = (a.x - c.x) * (b.y - c.y);
  const double right = (a.y - c.y) * (b.x - c.x);
  const double det = left - right;
  const double bound = 3.4e-16 * (std::abs(left) + std::abs(right));
  if (det > bound) return 1;
  return det < -bound ? -1 : 0;
}

/// Whether two segments without a common end meet, or may meet within rounding.
inline bool segments_meet(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  if (std::fmax(a.x, b.x) < std::fmin(c.x, d.x) || std::fmax(c.x, d.x) < std::fmin(a.x, b.x)) return false;
  if (std::fmax(a.y, b.y) < std::fmin(c.y, d.y) || std::fmax(c.y, d.y) < std::fmin(a.y, b.y)) return false;
  return orientation(a, b, c) * orientation(a, b, d) <= 0 && orientation(c, d, a) * orientation(c, d, b) <= 0;
}

/// Whether the segments from a common end to b and to c lie on each other.
inline bool segments_overlap(Vec2 common, Vec2 b, Vec2 c) {
  return orientation(common, b, c) == 0 && dot(b - common, c - common) >= 0;
}

}  // namespace knotreel::param
