// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "document/frame_models.h"
#include "document/frame_state.h"

/// Triangulations of links (docs/format.md, "Link codes"): every triangle is expected to be the one on the
/// same edge of the same link in the frame before.
namespace knotreel::document {

void write_links(const spline::SplineSpace& space, const FrameState* before, LinkModels& models,
                 ArithmeticWriter& out);

/// @param mesh  sound.
std::shared_ptr<const spline::SplineSpace> read_space(mesh::KnotMesh mesh, int degree,
                                                      const FrameState* before, LinkModels& models,
                                                      ArithmeticReader& in);

}  // namespace knotreel::document
