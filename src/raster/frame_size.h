// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/raster/render.h"

namespace knotreel::raster {

/// The picture and the part of it that is asked for, with all defaults filled in.
struct FrameSize {
  int width;
  int height;
  int crop_x;
  int crop_y;
  int crop_width;
  int crop_height;
  double pixel_width;  ///< of an output pixel, in pixels of the model
  double pixel_height;
};

/// @throws Error{kInvalidArgument}, see Renderer.
FrameSize resolve_size(const document::FrameModel& model, const RenderOptions& options);

}  // namespace knotreel::raster
