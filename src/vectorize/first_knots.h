#pragma once

#include "knotreel/knots/place.h"
#include "knotreel/mesh/editable_mesh.h"
#include "knotreel/vectorize/options.h"

namespace knotreel::vectorize {

/// How knots are put into a mesh at first (paper sec. 6.1): as many as the MEC asks for, or as bring it to so
/// many control points, about.
knots::PlaceOptions first_knots(const mesh::EditableMesh& mesh, double functions, const Options& options);

}  // namespace knotreel::vectorize
