// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "knotreel/knots/optimise.h"
#include "knots/face_fits.h"

namespace knotreel::knots {

/// optimise_connectivity() with the linear approximations that are known already.
std::size_t optimise_connectivity(mesh::EditableMesh& mesh, const Target& target,
                                  const OptimiseOptions& options, const std::vector<mesh::FaceIndex>& faces,
                                  FaceFits& fits);

}  // namespace knotreel::knots
