// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/image/image.h"
#include "palette.h"

namespace knotreel::video {

/// The pixels of a picture in a palette. What is between its colours is a mixture of two, in a pattern that
/// stays in its place (an ordered dither [Bayer73]), so that it neither bands nor flickers; colours of the
/// palette are plain. Pixels with alpha below a half get index 0.
/// @param before  indices of the frame before in the same palette, which stay where they are nearly right; or
///   none.
/// The result does not depend on the number of threads.
std::vector<std::uint8_t> dithered(const image::Image& picture, const Palette& palette,
                                   std::span<const std::uint8_t> before = {});

}  // namespace knotreel::video
