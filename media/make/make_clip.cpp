// SPDX-License-Identifier: GPL-3.0-or-later
#include <exception>
#include <filesystem>
#include <iostream>

#include "clip.h"
#include "knotreel/video/writer.h"

namespace {

using namespace knotreel;

void write_video(const std::string& path, int width, int height) {
  video::StreamInfo info;
  info.width = width;
  info.height = height;
  info.time_base = {1, media::kClipRate};
  info.frame_rate = {media::kClipRate, 1};
  info.sample_aspect = {1, 1};
  info.colour = {.range = 1, .matrix = 1, .primaries = 1, .transfer = 1, .chroma_location = 1};
  video::WriteOptions options;
  options.codec = "h264";
  options.crf = 17;
  options.preset = "veryslow";
  options.threads = 1;  // the bytes depend on it
  auto writer = video::VideoWriter::create(path, info, options);
  for (int i = 0; i < media::kClipFrames; ++i) writer.write(media::clip_frame(width, height, i), i, 1);
  writer.finish();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_clip FOLDER\n";
    return 2;
  }
  try {
    const std::filesystem::path folder = argv[1];
    const std::string silent = folder / "clip-silent.mp4";
    write_video(silent, 320, 180);
    media::add_sound(silent, media::clip_tune(), folder / "clip.mp4");
    std::filesystem::remove(silent);
  } catch (const std::exception& e) {
    std::cerr << "make_clip: " << e.what() << '\n';
    return 1;
  }
}
