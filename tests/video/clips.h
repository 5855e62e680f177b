// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/video/reader.h"
#include "knotreel/video/writer.h"

namespace knotreel::video {

/// What makes a clip for a test.
struct ClipSpec {
  StreamInfo info;
  std::vector<image::Image> images;
  std::vector<std::int64_t> pts;        ///< as many as images
  std::vector<std::int64_t> durations;  ///< as many as images
};

/// Frames of a smooth moving pattern, a tick apart.
ClipSpec moving_pattern(int width, int height, int channels, int frames);

WriteOptions with_codec(const std::string& codec, const std::string& pixel_format = {});

void write_clip(const std::string& path, const ClipSpec& clip, const WriteOptions& options = {});

/// A whole video in memory.
struct WholeClip {
  StreamInfo info;
  std::vector<Frame> frames;
  std::vector<Packet> packets;
  std::vector<std::string> warnings;
  std::uint64_t damaged = 0;
};
WholeClip read_clip(const std::string& path, const ReadOptions& options = {});

/// Writes a video again with its other streams copied. @return the writer's warnings.
std::vector<std::string> copy_clip(const std::string& from, const std::string& to,
                                   const ReadOptions& options = {});

/// Times in seconds.
std::vector<double> seconds(const WholeClip& clip);

double mean_difference(const image::Image& a, const image::Image& b);

/// The kind of the error that an action throws.
ErrorKind kind_of(const std::function<void()>& action);

}  // namespace knotreel::video
