// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "knotreel/image/image.h"
#include "knotreel/video/reader.h"
#include "knotreel/video/writer.h"

namespace knotreel::test {

/// A bright disc that moves to the right over a ramp, two pixels a frame; also at times between frames.
inline image::Image moving_picture_at(int width, int height, int channels, double frame) {
  image::Image image = image::make_image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double distance = std::hypot(x + 0.5 - 0.3 * width - 2 * frame, y + 0.5 - 0.5 * height);
      const double inside = std::clamp(0.25 * height - distance + 0.5, 0.0, 1.0);
      for (int c = 0; c < channels; ++c) {
        const double ramp = 40 + 120.0 * x / width + 20 * c + 30 * std::sin(0.2 * y);
        image.at(x, y, c) = float((1 - inside) * ramp + inside * (c == 2 ? 60 : 235));
      }
    }
  }
  return image;
}

inline image::Image moving_picture(int width, int height, int channels, int frame) {
  return moving_picture_at(width, height, channels, frame);
}

/// Writes a small video, without loss unless told so; returns the times of its frames in milliseconds.
/// Every third frame lasts twice as long.
inline std::vector<std::int64_t> write_clip(const std::string& path, int frames, int width = 64,
                                            int height = 48, const std::string& codec = "ffv1") {
  video::StreamInfo info;
  info.width = width;
  info.height = height;
  info.time_base = {1, 1000};
  info.frame_rate = {25, 1};
  video::WriteOptions options;
  options.codec = codec;
  video::VideoWriter writer = video::VideoWriter::create(path, info, options);
  std::vector<std::int64_t> times;
  std::int64_t time = 0;
  for (int i = 0; i < frames; ++i) {
    const std::int64_t duration = i % 3 == 2 ? 80 : 40;
    writer.write(moving_picture(width, height, 3, i), time, duration);
    times.push_back(time);
    time += duration;
  }
  writer.finish();
  return times;
}

/// Times of all frames of a video, in milliseconds.
inline std::vector<std::int64_t> frame_times(const std::string& path) {
  video::VideoReader reader = video::VideoReader::open(path);
  std::vector<std::int64_t> times;
  video::Frame frame;
  const double tick = reader.info().time_base.value() * 1000;
  while (reader.next(frame)) times.push_back(std::llround(double(frame.pts) * tick));
  return times;
}

}  // namespace knotreel::test
