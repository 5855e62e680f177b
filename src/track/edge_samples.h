// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "knotreel/mesh/knot_mesh.h"
#include "knotreel/motion/luma.h"
#include "knotreel/spline/basis.h"

/// Places along feature curves at which edges of a picture are looked for, across the curve.
namespace knotreel::track {

/// Levels over two steps of half a pixel; what has a smaller slope is no edge.
inline constexpr double kWeakestEdge = 6;

struct EdgeSearch {
  double reach = 2.5;       ///< how far from the curve an edge is looked for, pixels
  double dead_zone = 0.25;  ///< offsets below are none, pixels
};

struct EdgeSample {
  mesh::KnotIndex a = 0;
  mesh::KnotIndex b = 0;
  double t = 0;   ///< share of the way from a to b
  Vec2 before;    ///< in the picture before
  Vec2 position;  ///< in the new one, as far as the motion is known
  Vec2 normal;
  double offset = 0;   ///< along the normal
  double weight = 0;   ///< steepness; 0: nothing found
  bool known = false;  ///< there was an edge before
  std::size_t segment = 0;
};

/// Places of samples along all segments, in the image of the surface, moved with their ends.
/// @param mesh  whose segments are meant. @param motion of its knots.
std::vector<EdgeSample> place_samples(const spline::Basis& basis, std::span<const Vec2> displacement,
                                      const mesh::KnotMesh& mesh, std::span<const Vec2> motion);

/// Slope of the luma along a normal, levels over two steps: the steepest within half a pixel.
double steepest_at(const motion::Luma& luma, Vec2 p, Vec2 normal);

/// The steepest slope within reach, nearer ones preferred.
double steepest_near(const motion::Luma& luma, Vec2 p, Vec2 normal, double reach);

/// Sets offset, weight and known of a sample: the place along the normal with a slope most like a known one,
/// nearer ones preferred. @param known  below kWeakestEdge: there is nothing to look for.
void find_edge(double known, const motion::Luma& now, const EdgeSearch& search, EdgeSample& s);

}  // namespace knotreel::track
