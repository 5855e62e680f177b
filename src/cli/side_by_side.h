// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/turn.h"
#include "knotreel/document/frame_model.h"
#include "knotreel/image/image.h"

namespace knotreel::cli {

/// A picture of a frame, its model drawn larger, and the knot mesh over the frame, from left to right; each
/// enlarged as long as all three fit into an ordinary screen.
/// @param turn with which players show the video; the three are turned.
image::Image side_by_side(const image::Image& picture, const document::FrameModel& model, const Turn& turn);

}  // namespace knotreel::cli
