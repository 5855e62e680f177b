// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/image/image.h"
#include "knotreel/motion/luma.h"
#include "knotreel/spline/basis.h"
#include "track/edge_samples.h"

namespace knotreel::track {

struct SnapOptions {
  double least_found = 0.9;    ///< share of the samples of a segment that must find their edge again
  double least_parting = 0.5;  ///< share of them with different colours on both sides
  EdgeSearch search;           ///< around the carried curve
  int rounds = 2;              ///< of looking for edges and moving
  double stiffness =
      0.3;  ///< of the ends of segments against moving at all and apart, relative to the samples
};

struct SnapResult {
  std::vector<Vec2> moves;  ///< what to add to the motion, by knot; zero for all but ends of segments
  std::vector<std::uint8_t>
      lost;  ///< by segment: 1 if the new picture has no such edge there, or the old none
};

/// Pulls carried feature curves onto the edges of the new picture: along the normals of each curve the place
/// near by is found that is as steep as the edge was before, in the same direction, and the ends of the
/// segments move so that these offsets are met in the least-squares sense, each weighted by its steepness.
/// @param basis, displacement the surface of the frame before, which says where segments lie in the image.
/// @param mesh   whose segments are meant; near those of the surface.
/// @param motion of the knots so far. @param picture_before, before, now the pictures, and their luma.
SnapResult snap_to_edges(const spline::Basis& basis, std::span<const Vec2> displacement,
                         const mesh::KnotMesh& mesh, std::span<const Vec2> motion,
                         const image::Image& picture_before, const motion::Luma& before,
                         const motion::Luma& now, const SnapOptions& options = {});

}  // namespace knotreel::track
