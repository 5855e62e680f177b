// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/video/stream_info.h"
#include "libav.h"

namespace knotreel::video {

/// The tags that a reader will find, or go by, when frames with these were encoded so: many codecs tell
/// nothing of their colours, and few containers make up for it. Luma and chroma have to be those of what will
/// be found, or colours shift.
ColourTags carried_colours(const ColourTags& tags, AVCodecID codec, const AVOutputFormat& container);

}  // namespace knotreel::video
