// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/video/stream_info.h"
#include "libav.h"

/// What to take where a stream does not tell its colours; the same for reading and writing, so that what is
/// not told comes back as it was.
namespace knotreel::video {

/// Number of the matrix to use: an unknown one is BT.601 below 720 lines, else BT.709.
int matrix_in_use(int tagged, int height);

/// Whether luma takes the whole range. Not told: limited for luma and chroma, full for grey alone.
bool full_range(int tagged, const AVPixFmtDescriptor& format);

/// Weights of red and blue in luma.
struct LumaWeights {
  float red, blue;
  float green() const { return 1 - red - blue; }
};
LumaWeights luma_weights(int matrix);

/// Offset of chroma samples from the first luma sample of their cell, in luma pixels, 0 or 0.5 (1 at the
/// bottom). Not told: left.
struct ChromaPlace {
  double x, y;
};
ChromaPlace chroma_place(int tagged);

/// yuvj420p and its kin are formats with a range; this gives the format without it.
AVPixelFormat without_range(AVPixelFormat format);

bool is_rgb(const AVPixFmtDescriptor& format);   ///< also palettes
bool is_grey(const AVPixFmtDescriptor& format);  ///< with or without alpha
bool has_alpha(const AVPixFmtDescriptor& format);
/// Channels of an Image that hold all that a format holds.
int channels_of(const AVPixFmtDescriptor& format);
int depth_of(const AVPixFmtDescriptor& format);

}  // namespace knotreel::video
