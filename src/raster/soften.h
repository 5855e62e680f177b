// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "raster/feature_trace.h"
#include "raster/part.h"

namespace knotreel::raster {

/// How far the filter of soften_edges() reaches, in pixels of the grid.
inline constexpr int kSoftReach = 1;

struct Place {
  int x;
  int y;
};

/// The pixels of a region that a feature crosses, or that are next to such a one; each once.
std::vector<Place> next_to(std::span<const CrossedPixel> crossed, const Region& region);

/// Draws pixels next to features through the filter (s, 1 - 2 s, s) along both axes, as
/// document::FrameModel::edge_softness tells: those that a feature crosses, and their eight neighbours.
/// @param crossed  all such pixels of `drawn` and of one pixel around `inner`, row by row.
/// @param inner    what is to be softened; inside `drawn`, and by kSoftReach unless there the picture ends.
/// @param drawn    holds the pixels as they were; those of `inner` are changed in place.
void soften_edges(std::span<const CrossedPixel> crossed, double softness, const Part& inner,
                  const Part& drawn);

}  // namespace knotreel::raster
