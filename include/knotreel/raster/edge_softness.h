// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "knotreel/base/error.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/image/image.h"
#include "knotreel/spline/pixel_surface.h"

namespace knotreel::raster {

/// The document::FrameModel::edge_softness with which a model, drawn at its own size, misses a picture least
/// in the pixels next to its features (least squares); a multiple of document::kEdgeSoftnessStep. 0 without
/// features.
/// @param model   whatever softness it has itself does not matter. @param picture of its size and channels.
/// @param basis   of the space of the model; or null. @param known as for Renderer; or null.
/// @throws Error{kInvalidArgument} for a picture of another size or with other channels.
double fitting_edge_softness(document::FrameModel model, const image::Image& picture,
                             std::shared_ptr<const spline::Basis> basis,
                             std::shared_ptr<const spline::PixelSurface> known);

}  // namespace knotreel::raster
