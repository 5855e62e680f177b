// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>

#include "raster/part.h"

namespace knotreel::raster {

/// So many fine pixels, across and down, make one pixel.
struct Reduction {
  int x;
  int y;
};

/// Draws a region of the fine grid: row-major, channels interleaved. What it gives for a pixel does not
/// depend on the region.
using DrawFine = std::function<void(const Region& fine, float* out)>;

/// Fine samples that are held at once, at most; a fine row of one pixel has fewer.
inline constexpr std::size_t kMostFine = std::size_t{1} << 21;

/// Pixels of a part as means of fine pixels, which are added up row by row, whatever the order they are drawn
/// in. Memory does not depend on how many of them make a pixel.
void reduce_rows(const Part& part, Reduction by, const DrawFine& draw);

}  // namespace knotreel::raster
