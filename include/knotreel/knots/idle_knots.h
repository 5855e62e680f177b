// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::knots {

struct SwapOptions {
  double ratio = 40;        ///< a knot goes if the error that another one could mend is so many times its own
  double share = 0.02;      ///< most of the knots that go at once
  double longest_edge = 0;  ///< pixels; knots stay where there may be longer ones without them; 0: any may go
};

/// Errors of the faces of a surface, the largest first.
/// @param squared_errors per pixel of a picture of this width and height.
std::vector<double> sorted_face_errors(const mesh::EditableMesh& mesh, std::span<const float> squared_errors,
                                       int width, int height);

/// Takes away knots, free or on the border, that hardly earn their place, as many as there are faces with
/// much more error than these knots keep away: so many new ones are then worth inserting. A knot keeps away
/// what a single linear approximation of all its faces would add; a new knot is taken to mend half the error
/// of its face.
/// @param face_errors the largest first.
/// @param surplus     knots that go in any case, the idlest ones.
/// @return the number of knots removed.
std::size_t remove_idle_knots(mesh::EditableMesh& mesh, const Target& target,
                              std::span<const double> face_errors, const SwapOptions& options = {},
                              std::size_t surplus = 0);

}  // namespace knotreel::knots
