// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "knotreel/image/image.h"

namespace knotreel::media {

inline constexpr int kBenchClipRate = 25;  ///< frames per second

/// Kinds of clips that `knotreel bench` makes:
/// static   a ball moves, the camera and all else rest
/// pan      the camera moves, nothing else does
/// cuts     another shot every half second, everything in it moves
/// cartoon  flat colours with dark outlines
/// noise    a moving scene with the grain of a film, new in every frame
const std::vector<std::string>& bench_clip_names();

/// A frame of one of them, RGB; the same bits whenever and wherever it is drawn.
/// @param name  one of bench_clip_names().
image::Image bench_clip_frame(const std::string& name, int width, int height, int frame);

}  // namespace knotreel::media
