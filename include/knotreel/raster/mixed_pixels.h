#pragma once

#include <memory>

#include "knotreel/document/frame_model.h"
#include "knotreel/fit/mixed_pixels.h"
#include "knotreel/spline/basis.h"

namespace knotreel::raster {

/// The pixels of a picture of the size of the model that features cross, and the places whose colours each is
/// the mean of when it is drawn, about: 16 where features do not split it in two. Without weights and
/// colours. Work is spread over all threads allowed; the result does not depend on their number.
/// @param model its colours do not matter. @param basis of its space.
fit::MixedPixels mixed_pixels(const document::FrameModel& model, std::shared_ptr<const spline::Basis> basis);

}  // namespace knotreel::raster
