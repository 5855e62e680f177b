// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "knotreel/spline/piece.h"
#include "knotreel/spline/reference.h"

namespace knotreel::spline {

inline bool inside_walls(const Tent& tent, Vec2 u, Vec2 direction) {
  for (int i = 0; i < tent.wall_count; ++i) {
    if (!inside_wall(tent.walls[static_cast<std::size_t>(i)], u, direction)) return false;
  }
  return true;
}

/// Value of a tent at u, zero outside its support.
inline double tent_value(const Tent& tent, Vec2 u, Vec2 direction) {
  double value = tent.constant;
  if (tent.slope_count > 0) {
    value = tent.slopes[0](u);
    for (int i = 1; i < tent.slope_count; ++i) {
      const double v = tent.slopes[static_cast<std::size_t>(i)](u);
      value = v < value ? v : value;
    }
    if (!(value > 0)) return 0;
  }
  return inside_walls(tent, u, direction) ? value : 0;
}

/// Value and gradient, as limits from the side of `direction`: on a crease, and on the edge of the support,
/// the linear function that rules on that side counts.
inline Jet tent_jet(const Tent& tent, Vec2 u, Vec2 direction) {
  if (tent.slope_count == 0) {
    return inside_walls(tent, u, direction) ? Jet{tent.constant, 0, 0, 0, 0, 0} : Jet{};
  }
  const auto rise = [&](const Affine& a) { return a.nx * direction.x + a.ny * direction.y; };
  // Whether linear function a (value va) is below b (value vb) just beside u; equal within kOnWall pixels.
  const auto below = [&](const Affine& a, double va, const Affine& b, double vb) {
    // Nearly always they are so far from equal that the length of the gradient need not be known.
    const double dx = a.nx - b.nx;
    const double dy = a.ny - b.ny;
    if (std::abs(va - vb) > 2 * kOnWall * (std::abs(dx) + std::abs(dy))) return va < vb;
    const double tolerance = kOnWall * std::sqrt(dx * dx + dy * dy);
    return std::abs(va - vb) <= tolerance ? rise(a) < rise(b) : va < vb;
  };
  const Affine* active = &tent.slopes[0];
  double value = (*active)(u);
  for (int i = 1; i < tent.slope_count; ++i) {
    const Affine& slope = tent.slopes[static_cast<std::size_t>(i)];
    const double v = slope(u);
    if (below(slope, v, *active, value)) {
      value = v;
      active = &slope;
    }
  }
  if (below(*active, value, Affine{}, 0) || !inside_walls(tent, u, direction)) return {};
  return {value, active->nx, active->ny, 0, 0, 0};
}

}  // namespace knotreel::spline
