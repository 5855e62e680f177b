// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "export/paint.h"
#include "export/triangulation.h"

namespace knotreel::exporting {

struct RegionOptions {
  std::size_t first = 0;  ///< channels to paint: `count` of them, one to three
  std::size_t count = 3;
  double colour_tolerance = 4;  ///< largest error of a paint, in levels
  /// A region goes to a neighbour if its width times what the neighbour's paint is off there is below: levels
  /// times pixels.
  double hidden = 4;
  std::function<void()> checkpoint;
};

/// A set of triangles that hang together and one paint for them.
struct Region {
  Paint paint;
  bool flat = false;        ///< the paint's colour alone will do
  double area = 0;          ///< squares of pixels
  double from = 0, to = 0;  ///< range along the paint's direction, from its centre
};

struct Partition {
  std::vector<std::uint32_t> region_of;  ///< by triangle
  std::vector<Region> regions;
};

/// Puts triangles together while one paint fits them, pairs that lose least first (region merging as of
/// Koepfler, Lopez and Morel 1994, with paints in place of constants); then gives what is too thin to be seen
/// to a neighbour. The same for equal input.
Partition merge_triangles(const Triangulation& triangles, const RegionOptions& options);

}  // namespace knotreel::exporting
