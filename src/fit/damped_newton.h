// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/vec2.h"

namespace knotreel::fit {

struct DampedNewtonOptions {
  double tolerance = 1e-9;  ///< of what the place misses the target by, pixels: near enough
  int max_steps = 40;
  double shortest = 1e-3;  ///< share of a step that is tried last
};

/// Where a map takes a point, and its derivatives.
struct MapValue {
  Vec2 at, by_x, by_y;
};

/// A place, and by how much its image misses the target.
struct Attempt {
  Vec2 place;
  double miss;
};

/// Looks for the place that a map takes to `target`, by steps of Newton's method that are halved until they
/// make it better: there may be a kink on the way.
/// @param map Vec2 -> MapValue. @param clamped takes a point to the nearest one of the domain.
template <class Map, class Clamped>
Attempt damped_newton(Vec2 target, Vec2 start, const DampedNewtonOptions& options, Map&& map,
                      Clamped&& clamped) {
  Vec2 u = clamped(start);
  MapValue v = map(u);
  Attempt best{u, norm(target - v.at)};
  for (int step = 0; step < options.max_steps && best.miss > options.tolerance; ++step) {
    const Vec2 miss = target - v.at;
    const double area = cross(v.by_x, v.by_y);
    const Vec2 move = area > 0.05 ? Vec2{cross(miss, v.by_y) / area, cross(v.by_x, miss) / area} : miss;
    bool is_better = false;
    for (double t = 1; t > options.shortest && !is_better; t *= 0.5) {
      const Vec2 next = clamped(u + t * move);
      const MapValue value = map(next);
      const double length = norm(target - value.at);
      if (length >= best.miss) continue;
      u = next;
      v = value;
      best = {u, length};
      is_better = true;
    }
    if (!is_better) break;
  }
  return best;
}

}  // namespace knotreel::fit
