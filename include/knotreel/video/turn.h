#pragma once

#include "knotreel/image/image.h"
#include "knotreel/video/stream_info.h"

/// Phones store pictures as their sensor lies, and tell players how to turn them.
namespace knotreel::video {

/// Where a player puts the pixels of a picture: turned by whole quarters, and mirrored if it says so.
struct Turn {
  /// Of a step to the right, and of one down, in the coded picture: where it leads in the one shown.
  int right_x = 1, right_y = 0;
  int down_x = 0, down_y = 1;

  bool is_none() const { return right_x == 1 && down_y == 1; }
  bool swaps_sides() const { return right_x == 0; }
};

/// That of a display matrix; none if there is no matrix, or one that does anything but quarter turns.
Turn turn_of(const StreamInfo& info);

/// The picture as it is shown. Safe to call from several threads.
image::Image turned(const image::Image& image, const Turn& turn);

/// What is known of frames that have been turned.
StreamInfo turned(StreamInfo info, const Turn& turn);

}  // namespace knotreel::video
