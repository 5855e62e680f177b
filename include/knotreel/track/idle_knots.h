#pragma once

#include <cstddef>
#include <span>

#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::track {

struct SwapOptions {
  double ratio = 40;    ///< a knot goes if the error that another one could mend is so many times its own
  double share = 0.06;  ///< most of the knots that go at once
};

/// Takes away free knots that hardly earn their place, as many as there are faces with much more error than
/// these knots keep away: so many new ones are then worth inserting. A knot keeps away what a single linear
/// approximation of all its faces would add; a new knot is taken to mend half the error of its face.
/// @param squared_errors of the surface, per pixel of the target's picture.
/// @param surplus knots that go in any case, the idlest ones.
/// @return the number of knots removed.
std::size_t remove_idle_knots(mesh::EditableMesh& mesh, const knots::Target& target,
                              std::span<const float> squared_errors, const SwapOptions& options = {},
                              std::size_t surplus = 0);

}  // namespace knotreel::track
