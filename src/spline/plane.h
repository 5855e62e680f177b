// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/spline/piece.h"

namespace knotreel::spline {

/// c + x (ux - ox) + y (uy - oy) with an origin o that many planes share: quicker than Affine where there are
/// many points, and as precise near the origin.
template <class Value>
struct PlaneIn {
  Value c = 0;
  Value x = 0;
  Value y = 0;
};
using Plane = PlaneIn<double>;

inline Plane operator-(const Plane& a, const Plane& b) {
  return {a.c - b.c, a.x - b.x, a.y - b.y};
}

template <class Value>
PlaneIn<Value> plane_in(const Plane& p) {
  return {static_cast<Value>(p.c), static_cast<Value>(p.x), static_cast<Value>(p.y)};
}

inline Plane plane_of(const Affine& a, Vec2 origin) {
  return {a(origin), a.nx, a.ny};
}

}  // namespace knotreel::spline
