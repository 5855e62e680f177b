// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace knotreel::video {

/// Writes a tone, and beside it 25 frames of video per second if wanted, with libav alone: the module under
/// test has no part in it.
/// @param codec  of the sound: "aac", whose first packet has a time before zero, or "pcm_s16le".
void write_sound_clip(const std::string& path, const std::string& codec, bool video, int seconds = 1);

/// Writes a second of video with two tones as AAC.
void write_clip_with_two_sounds(const std::string& path);

/// Writes H.264 of which pictures before a keyframe, but behind it in the file, need pictures of the group
/// before it ("open GOP"): waves that move, 128x96, 25 frames per second, a keyframe in each second.
void write_open_gop_clip(const std::string& path, int seconds);

/// Writes a second of video with three texts as mp4 has them, nothing between them.
void write_clip_with_mp4_texts(const std::string& path);

/// Writes a second of video with sound as AAC, three texts as SubRip in German, and a font. Matroska only.
void write_titled_clip(const std::string& path);

}  // namespace knotreel::video
