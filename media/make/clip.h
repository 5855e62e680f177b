// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "knotreel/image/image.h"

namespace knotreel::media {

inline constexpr int kClipRate = 25;     ///< frames per second
inline constexpr int kClipFrames = 100;  ///< the cut is in the middle
inline constexpr int kSoundRate = 44100;

/// A frame of the clip: shaded balls before a panning textured wall, then, after a hard cut, a turning box in
/// the sky above hills. RGB, drawn with 3 x 3 samples per pixel.
image::Image clip_frame(int width, int height, int frame);

/// A short tune as long as the clip: one channel, -1 to 1.
std::vector<float> clip_tune();

/// Copies the video of one file into another and puts sound, encoded as AAC, beside it.
/// @throws std::runtime_error
void add_sound(const std::string& video, const std::vector<float>& sound, const std::string& output);

}  // namespace knotreel::media
