#pragma once

#include <string>

#include "knotreel/document/frame_model.h"
#include "knotreel/image/image.h"

namespace knotreel::cli {

/// A document of one frame in memory, and that frame as it was stored, that is quantised.
struct StillDocument {
  std::string bytes;
  document::FrameModel model;
};

/// @param image  that the model was made from.
StillDocument still_document(const image::Image& image, const document::FrameModel& model);

}  // namespace knotreel::cli
