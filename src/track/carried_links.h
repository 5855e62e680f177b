// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/knots/target.h"
#include "knotreel/spline/space.h"
#include "spline/named_links.h"

namespace knotreel::track {

/// How the links of a space are triangulated, by the ids of their knots, so that the space of the next frame
/// can have the same links where the ring around a knot is the same: another triangulation shows as a jump
/// of the surface.
class LinkMemory {
 public:
  explicit LinkMemory(const spline::SplineSpace& space);

  /// The space over another mesh: links known from here, as long as none of their triangles is flat now; the
  /// others chosen by the picture.
  spline::SplineSpace space_over(mesh::KnotMesh mesh, int degree, const knots::Target& target) const;

 private:
  spline::NamedLinks links_;
};

}  // namespace knotreel::track
