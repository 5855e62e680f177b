// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::knots {

struct RefineOptions {
  std::size_t max_knots = 100;     ///< to insert
  std::size_t least_cluster = 15;  ///< pixels; smaller clusters are left alone (paper sec. 8.1)
  double min_distance = 1.0;       ///< as in PlaceOptions
};

/// Inserts knots where the surface misses the picture (paper sec. 8.1): pixels with a large error are grouped
/// in clusters, two pixels at most two apart belonging together, and each cluster gets knots at the pixels
/// around which the error, summed over their two-ring, is largest. Where the paper sets the threshold by the
/// number of the round and takes ten knots per cluster, here the threshold falls until the knots asked for
/// are found, and the largest sums over all clusters come first.
/// @param squared_errors per pixel, row-major, as large as the target's picture.
/// @param places         of the pixels in the domain; empty: their centres.
/// @return the knots inserted. The mesh is not made Delaunay around them.
std::vector<mesh::KnotIndex> refine_knots(mesh::EditableMesh& mesh, std::span<const float> squared_errors,
                                          std::span<const Vec2> places, int width, int height,
                                          const RefineOptions& options);

/// A point on a feature segment, and how far the surface is from the feature curve there.
struct CurveError {
  std::uint32_t segment = 0;  ///< index in KnotMesh::segments
  Vec2 place;                 ///< in the domain
  double error = 0;           ///< pixels
};

/// Inserts two knots evenly into each interval between knots of a feature segment where the error of a point
/// is above a bound (paper sec. 8.1), if the interval is long enough to keep them `min_distance` apart.
/// @return the knots inserted.
std::vector<mesh::KnotIndex> refine_features(mesh::EditableMesh& mesh, std::span<const CurveError> errors,
                                             double bound, double min_distance);

/// Knots that local optimisation may move after an insertion (paper sec. 8.2): the new ones and so many rings
/// of neighbours, two in the paper.
/// @return by place for a knot, whether it may be moved; as optimise() takes it.
std::vector<bool> rings_around(const mesh::EditableMesh& mesh, const std::vector<mesh::KnotIndex>& knots,
                               int count);

}  // namespace knotreel::knots
