// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/document/stored_mesh.h"

#include <cmath>
#include <utility>

#include "document/bytes.h"
#include "document/canonical.h"
#include "document/quantise.h"
#include "knotreel/base/error.h"

namespace knotreel::document {

namespace {

CanonicalMesh rounded_mesh(const mesh::KnotMesh& mesh, int knot_bits) {
  try {
    CanonicalMesh numbering = canonical_mesh(mesh);
    quantise_knots(numbering, knot_bits);
    return numbering;
  } catch (const Malformed& e) {
    throw Error(ErrorKind::kInvalidArgument, std::string("cannot store a frame: ") + e.what());
  }
}

}  // namespace

StoredMesh stored_mesh(const mesh::KnotMesh& mesh, int knot_bits) {
  CanonicalMesh numbering = rounded_mesh(mesh, knot_bits);
  return {std::move(numbering.mesh), std::move(numbering.knot_of)};
}

StoredSpace stored_space(const std::shared_ptr<const spline::SplineSpace>& space, int knot_bits) {
  const CanonicalMesh numbering = rounded_mesh(space->mesh(), knot_bits);
  StoredSpace stored{canonical_space(space, numbering.mesh, numbering), {}};
  stored.function_of = function_map(*space, *stored.space, numbering);
  return stored;
}

void round_displacement(std::vector<Vec2>& displacement, double step) {
  for (Vec2& d : displacement) d = {std::round(d.x / step) * step, std::round(d.y / step) * step};
}

void round_colours(std::vector<double>& colours, double step) {
  for (double& c : colours) c = std::round(c / step) * step;
}

}  // namespace knotreel::document
