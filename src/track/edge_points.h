// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "knotreel/fit/geometry_fit.h"
#include "knotreel/motion/luma.h"
#include "knotreel/spline/basis.h"
#include "track/edge_samples.h"

namespace knotreel::track {

/// Points of the curves of a surface, and the edges of the picture next to them.
struct EdgePoints {
  std::vector<fit::CurvePoint> points;  ///< on the edge if there is one, else where the curve is
  double rms = 0;                       ///< of the distances, pixels
};

/// Looks along the normals of all feature curves for the edges of a picture; of the steep places those of the
/// direction that most of the segment has, and the nearest.
EdgePoints find_edge_points(const spline::Basis& basis, std::span<const Vec2> displacement,
                            const motion::Luma& now, const EdgeSearch& search = {});

/// Mean distance of the curves from the edges next to them, wherever within reach; places without an edge do
/// not count. Pixels.
double mean_edge_distance(const spline::Basis& basis, std::span<const Vec2> displacement,
                          const motion::Luma& picture);

}  // namespace knotreel::track
