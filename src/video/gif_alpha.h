// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <istream>

#include "libav.h"

namespace knotreel::video {

/// Whether no pixel is transparent, of a frame in a format with alpha of 8 bits in every fourth byte.
bool is_opaque(const AVFrame& frame);

/// Whether a GIF whose first frame is opaque stays so: none of its frames is cleared before the next one
/// comes (GIF89a, section 23, disposal method 2). libav's frames have alpha in any case.
/// @return false if that cannot be told, since it is no whole GIF.
bool stays_opaque(std::istream& gif);

/// Has the frame of a packet of libav's encoder cleared before the next one comes, which it only has where
/// the frame itself is transparent somewhere. @pre packets are of whole pictures.
void clear_before_next(AVPacket& packet);

}  // namespace knotreel::video
