// SPDX-License-Identifier: GPL-3.0-or-later
#include "clips.h"

#include <gtest/gtest.h>

#include <cmath>

// x265 does not free all of its parameters.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libx265\n";
}

namespace knotreel::video {
namespace {

image::Image pattern(int width, int height, int channels, int number) {
  image::Image image = image::make_image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        const double phase = 0.13 * x + 0.07 * y * (c + 1) + 0.4 * number + c;
        image.at(x, y, c) = float(std::round(128 + 90 * std::sin(phase)));
      }
    }
  }
  return image;
}

}  // namespace

ClipSpec moving_pattern(int width, int height, int channels, int frames) {
  ClipSpec clip;
  clip.info.width = width;
  clip.info.height = height;
  clip.info.channels = channels;
  clip.info.time_base = {1, 25};
  clip.info.frame_rate = {25, 1};
  for (int i = 0; i < frames; ++i) {
    clip.images.push_back(pattern(width, height, channels, i));
    clip.pts.push_back(i);
    clip.durations.push_back(1);
  }
  return clip;
}

WriteOptions with_codec(const std::string& codec, const std::string& pixel_format) {
  WriteOptions options;
  options.codec = codec;
  options.pixel_format = pixel_format;
  options.threads = 1;
  return options;
}

void write_clip(const std::string& path, const ClipSpec& clip, const WriteOptions& options) {
  VideoWriter writer = VideoWriter::create(path, clip.info, options);
  for (std::size_t i = 0; i < clip.images.size(); ++i) {
    writer.write(clip.images[i], clip.pts[i], clip.durations[i]);
  }
  writer.finish();
}

WholeClip read_clip(const std::string& path, const ReadOptions& options) {
  VideoReader reader = VideoReader::open(path, options);
  WholeClip clip;
  clip.info = reader.info();
  Frame frame;
  while (reader.next(frame)) {
    clip.packets.insert(clip.packets.end(), frame.packets.begin(), frame.packets.end());
    clip.frames.push_back(std::move(frame));
  }
  const std::vector<Packet> rest = reader.remaining_packets();
  clip.packets.insert(clip.packets.end(), rest.begin(), rest.end());
  clip.warnings = reader.warnings();
  clip.damaged = reader.damaged();
  return clip;
}

std::vector<std::string> copy_clip(const std::string& from, const std::string& to,
                                   const ReadOptions& options) {
  VideoReader reader = VideoReader::open(from, options);
  VideoWriter writer = VideoWriter::create(to, reader.info(), {}, &reader);
  Frame frame;
  while (reader.next(frame)) {
    writer.write_packets(frame.packets);
    writer.write(frame.image, frame.pts, frame.duration);
  }
  writer.write_packets(reader.remaining_packets());
  writer.finish();
  return writer.warnings();
}

std::vector<double> seconds(const WholeClip& clip) {
  std::vector<double> times;
  for (const Frame& frame : clip.frames) times.push_back(double(frame.pts) * clip.info.time_base.value());
  return times;
}

double mean_difference(const image::Image& a, const image::Image& b) {
  if (a.width != b.width || a.height != b.height || a.channels != b.channels) return INFINITY;
  double sum = 0;
  for (std::size_t i = 0; i < a.samples.size(); ++i) sum += std::abs(double(a.samples[i] - b.samples[i]));
  return sum / double(a.samples.size());
}

ErrorKind kind_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos);
    return e.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::kInternal;
}

}  // namespace knotreel::video
