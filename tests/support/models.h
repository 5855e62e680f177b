// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "knotreel/document/frame_model.h"
#include "support/mesh_cases.h"

namespace knotreel::testing {

/// A model over a mesh with zero displacement and zero colours.
document::FrameModel blank_model(const mesh::KnotMesh& mesh, int degree, int channels);

/// Random displacements up to `reach` pixels (zero along the normal of the sides, so that the picture is
/// filled), scaled down until the map from parameters to image has a Jacobian safely above zero.
void displace_randomly(document::FrameModel& model, double reach, std::uint64_t seed);

/// Random colours in 0..255.
void colour_randomly(document::FrameModel& model, std::uint64_t seed);

}  // namespace knotreel::testing
