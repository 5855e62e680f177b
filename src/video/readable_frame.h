// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "libav.h"

namespace knotreel::video {

/// The samples of a frame in a format that swscale reads, if it does not read that of the frame: semi-planar
/// and packed ones as planes, mosaics of raw sensors (Bayer) as RGB. Null if there is no need to, or no way.
FramePtr readable_frame(const AVFrame& frame);

}  // namespace knotreel::video
