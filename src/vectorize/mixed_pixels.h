// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "knotreel/document/frame_model.h"
#include "knotreel/fit/mixed_pixels.h"
#include "knotreel/image/image.h"
#include "knotreel/spline/basis.h"

namespace knotreel::vectorize {

/// The pixels that features cross, as they will be drawn, with their colours (docs/decisions/0038).
/// @param model its colours do not matter, and may be missing. @param basis of its space. @param weight of
/// each, above 0; less where edges come in steps. @param tiles as for raster::mixed_pixels().
fit::MixedPixels mixed_pixels(document::FrameModel model, const std::shared_ptr<const spline::Basis>& basis,
                              const image::Image& picture, double weight,
                              std::span<const std::uint8_t> tiles = {});

}  // namespace knotreel::vectorize
