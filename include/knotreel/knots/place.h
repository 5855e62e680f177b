// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::knots {

struct PlaceOptions {
  std::size_t max_knots = 1000;  ///< no more knots than this in all
  double mec = 0;  ///< stop when the root mean square error per pixel of the best piecewise linear
                   ///< approximation is below this; levels, 0..255
  /// And the squared error, summed over its pixels, of each face.
  double face_error = std::numeric_limits<double>::infinity();
  double min_distance = 1.0;  ///< of a new knot from others, from features and from the border; pixels
};

/// Greedy insertion (paper sec. 6.1): again and again a knot goes into the face with the largest squared
/// error of its best linear approximation, at the centroid of that error; Delaunay is restored around it.
/// Where the centroid is close to a feature or to the border, the knot goes onto that line.
/// @param mesh constrained Delaunay. @return the number of knots inserted. Deterministic.
std::size_t insert_knots(mesh::EditableMesh& mesh, const Target& target, const PlaceOptions& options);

/// Inserts a knot in a face, as near to `wanted` as the distances allow, or on one of its fixed edges if it
/// is close to that; without making the mesh Delaunay again.
/// @return nothing if there is no room.
std::optional<mesh::KnotIndex> insert_near(mesh::EditableMesh& mesh, mesh::FaceIndex face, Vec2 wanted,
                                           double min_distance);

}  // namespace knotreel::knots
