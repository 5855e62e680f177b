// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "knotreel/document/frame_model.h"
#include "knotreel/fit/mixed_pixels.h"
#include "knotreel/spline/basis.h"

namespace knotreel::raster {

/// The pixels of a picture of the size of the model that features cross, and the places whose colours each is
/// the mean of when it is drawn, about: 16 where features do not split it in two. Without weights and
/// colours. Work is spread over all threads allowed; the result does not depend on their number.
/// @param model its colours do not matter. @param basis of its space. @param tiles by tile of
/// spline::PixelTiles: 1 for those whose pixels are looked for. None: all are.
fit::MixedPixels mixed_pixels(const document::FrameModel& model, std::shared_ptr<const spline::Basis> basis,
                              std::span<const std::uint8_t> tiles = {});

}  // namespace knotreel::raster
