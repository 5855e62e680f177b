// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "export/sheets.h"

namespace knotreel::exporting {

inline Curve straight(Vec2 a, Vec2 b) {
  return {a, a, b, b};
}
inline bool is_straight(const Curve& c) {
  return c[0] == c[1] && c[2] == c[3];
}

/// A chain of curves, each beginning where the one before ends, with as few as will do: straight ones are
/// simplified (Douglas and Peucker 1973), smooth ones become one cubic Bezier where that is near enough
/// (Schneider, "An algorithm for automatically fitting digitized curves", Graphics Gems 1990). Corners stay.
/// Not empty. @param tolerance  in pixels of the picture.
std::vector<Curve> simplified(const std::vector<Curve>& chain, double tolerance);

}  // namespace knotreel::exporting
