// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "knotreel/document/frame_model.h"
#include "knotreel/image/image.h"
#include "knotreel/vectorize/vectorize.h"

namespace knotreel::cli {

/// A document of one frame in memory, and that frame as it was stored, that is quantised.
struct StillDocument {
  std::string bytes;
  document::FrameModel model;
};

/// @param image  that the model was made from.
StillDocument still_document(const image::Image& image, const document::FrameModel& model);

/// What to tell of how a picture was made, for warn_of().
std::vector<std::string> warnings_of(const vectorize::Report& report);

}  // namespace knotreel::cli
