// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/turn.h"
#include "knotreel/image/image.h"
#include "knotreel/video/stream_info.h"

/// Phones store pictures as their sensor lies, and tell players how to turn them.
namespace knotreel::video {

/// That of a display matrix; none if there is no matrix, or one that does anything but quarter turns.
Turn turn_of(const StreamInfo& info);

/// The picture as it is shown. Safe to call from several threads.
image::Image turned(const image::Image& image, const Turn& turn);

/// What is known of frames that have been turned.
StreamInfo turned(StreamInfo info, const Turn& turn);

}  // namespace knotreel::video
