// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "cli/debug/canvas.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/features/chains.h"
#include "knotreel/mesh/knot_mesh.h"
#include "knotreel/param/parametrization.h"

/// What the stages of vectorizing made, drawn over the picture.
namespace knotreel::cli::debug {

/// Curves in changing colours, with a dot per point and a larger one per node.
/// @param before the same curves as they were, in grey below; or null.
Canvas draw_chains(const image::Image& picture, const features::FeatureChains& chains,
                   const features::FeatureChains* before);

/// In the parametric domain: where every eighth row and column of pixels went, and the feature polylines with
/// their vertices.
Canvas draw_parametrization(const image::Image& picture, const param::Parametrization& parametrization);

/// A knot mesh in the parametric domain; features red, multiple knots as white dots, others as small ones.
/// @param scale canvas pixels per pixel; 0: debug_scale().
Canvas draw_mesh(const image::Image& picture, const mesh::KnotMesh& mesh, int scale = 0);

/// The knot mesh of a model where its geometry part puts it, so that features lie on the edges they follow.
Canvas draw_mapped_mesh(const image::Image& picture, const document::FrameModel& model, int scale = 0);

/// Control points where their displaced Greville sites are, filled with their colours, and joined as the
/// t-configs of the surface join them (over a mesh of degree 1, that is along its edges).
Canvas draw_control_net(const image::Image& picture, const document::FrameModel& model);

}  // namespace knotreel::cli::debug
