// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "libav.h"

namespace knotreel::video {

/// libwebp does not know when an animation ends, and gives its last frame the mean duration of the others.
/// @param packet  an animated WebP; anything else stays as it is. @param milliseconds  from its first frame.
void end_webp_at(AVPacket& packet, std::int64_t milliseconds);

}  // namespace knotreel::video
