// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/document/frame_model.h"
#include "knotreel/motion/luma.h"
#include "knotreel/spline/basis.h"

namespace knotreel::track {

/// Mean distance between the feature curves of a model, where its surface puts them, and the edges of a
/// picture, looked for along the normals of the curves up to 2.5 pixels away. Places without any edge do not
/// count. Pixels; 0 if there are no curves.
/// @param picture of the size of the model's domain.
double curve_error(const document::FrameModel& model, const motion::Luma& picture);
/// @param basis of the space of the model, for callers who have it.
double curve_error(const document::FrameModel& model, const spline::Basis& basis,
                   const motion::Luma& picture);

}  // namespace knotreel::track
