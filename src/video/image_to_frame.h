// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/image/image.h"
#include "knotreel/video/stream_info.h"
#include "libav.h"

namespace knotreel::video {

/// An Image in a pixel format of libav, rounded to nearest without dither (but in palettes): what came
/// exactly from RGB or grey goes back exactly. Chroma is the mean of its pixels, about the place that the
/// tags tell. Colours without a place in the format are lost: grey formats take luma, in formats without
/// alpha, pictures are on black.
/// @param coded_height  decides on an unknown matrix.
/// @param before  the frame before, in the same format and size, for rounding that does not flicker: samples
///   that were near enough to what they should be now stay as they were (decision 41). What is exact stays
///   exact. Null: all samples are the nearest ones.
FramePtr packed_frame(const image::Image& image, AVPixelFormat format, const ColourTags& colour,
                      int coded_height, const AVFrame* before = nullptr);

/// The picture with other channels: like widen_channels, and the other way by luma, and on black.
image::Image with_channels(const image::Image& image, int channels);

}  // namespace knotreel::video
