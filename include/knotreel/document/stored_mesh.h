// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/base/vec2.h"
#include "knotreel/mesh/knot_mesh.h"
#include "knotreel/spline/space.h"

namespace knotreel::document {

/// Thrown for a mesh of which a face is flipped or flat even on the finest grid, 2^-14 px.
class FlatFace : public Error {
 public:
  explicit FlatFace(const std::string& message) : Error(ErrorKind::kInvalidArgument, message) {}
};

/// A knot mesh as documents have it: rounded to the grid, and with knots, faces and segments in the order of
/// the file.
struct StoredMesh {
  mesh::KnotMesh mesh;
  std::vector<mesh::KnotIndex> knot_of;  ///< by knot: its index in the mesh given
};

/// A model over such a mesh is stored with the very space that it has, so that whoever fits it knows what
/// will be drawn, and what was set up for the space serves for drawing too.
/// @param mesh sound. @param knot_bits  the grid is 2^-knot_bits px, or a finer one if faces would flip.
/// @throws FlatFace if they do on all of them. @throws Error{kInvalidArgument} as Writer::append().
StoredMesh stored_mesh(const mesh::KnotMesh& mesh, int knot_bits);

/// The space over such a mesh, with the links of the space given.
struct StoredSpace {
  std::shared_ptr<const spline::SplineSpace> space;
  std::vector<spline::FunctionIndex> function_of;  ///< by function: its index in the space given
};

/// @param knot_bits as for stored_mesh(). @throws likewise.
StoredSpace stored_space(const std::shared_ptr<const spline::SplineSpace>& space, int knot_bits);

/// Rounds displacements as documents do. What is carried and bent for many frames leaves traces of a few
/// thousandths of a pixel everywhere, which become none; pixels that are not displaced at all cost far less.
/// @param step in pixels, as EncodeOptions::displacement_step.
void round_displacement(std::vector<Vec2>& displacement, double step);

/// Rounds the colours of control points as documents do.
/// @param step in levels, as EncodeOptions::colour_step; for frames that are no keyframes, times
/// EncodeOptions::delta_coarseness.
void round_colours(std::vector<double>& colours, double step);

}  // namespace knotreel::document
