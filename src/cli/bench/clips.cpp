// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench/clips.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <future>

#include "bench_clips.h"
#include "cli/interrupt.h"
#include "knotreel/base/parallel.h"
#include "knotreel/image/resize.h"
#include "knotreel/video/reader.h"

namespace knotreel::cli::bench {
namespace {

constexpr Size kMadeSize{640, 360};
constexpr std::uint64_t kMadeFrames = 60;

bool is_made(const std::string& wanted) {
  const auto& names = media::bench_clip_names();
  return std::find(names.begin(), names.end(), wanted) != names.end() && !std::filesystem::exists(wanted);
}

video::VideoReader open_clip(const std::string& path, int threads) {
  video::ReadOptions options;
  options.threads = threads;
  options.copy_streams = false;
  return video::VideoReader::open(path, options);
}

/// In the colours and with the sampling of nearly all videos.
void make_clip(const Clip& clip, std::uint64_t frames) {
  video::StreamInfo info;
  info.width = clip.width;
  info.height = clip.height;
  info.pixel_format = "yuv420p";
  info.time_base = {1, media::kBenchClipRate};
  info.frame_rate = {media::kBenchClipRate, 1};
  info.sample_aspect = {1, 1};
  info.colour = {.range = 1, .matrix = 1, .primaries = 1, .transfer = 1, .chroma_location = 1};
  video::WriteOptions lossless;
  lossless.codec = "ffv1";
  auto writer = video::VideoWriter::create(clip.path, info, lossless);
  for (std::uint64_t i = 0; i < frames; ++i) {
    check_interrupted();
    writer.write(media::bench_clip_frame(clip.name, clip.width, clip.height, int(i)), std::int64_t(i), 1);
  }
  writer.finish();
}

void store_scaled(video::VideoReader& reader, const Clip& clip, std::uint64_t frames) {
  video::StreamInfo info = reader.info();
  info.width = clip.width;
  info.height = clip.height;
  video::WriteOptions nearly_lossless;
  nearly_lossless.codec = "h264";
  nearly_lossless.crf = 10;
  nearly_lossless.preset = "superfast";  // slower ones (macroblock trees) make another file each time
  auto writer = video::VideoWriter::create(clip.path, info, nearly_lossless);
  video::Frame frame;
  for (std::uint64_t i = 0; (frames == 0 || i < frames) && reader.next(frame); ++i) {
    check_interrupted();
    writer.write(image::resize(frame.image, clip.width, clip.height), frame.pts, frame.duration);
  }
  writer.finish();
}

}  // namespace

Clip prepare_clip(const std::string& wanted, const std::optional<Size>& size, std::uint64_t frames,
                  const Scratch& scratch) {
  Clip clip{wanted, scratch.path("clip.mkv")};
  if (is_made(wanted)) {
    clip.width = size.value_or(kMadeSize).width;
    clip.height = size.value_or(kMadeSize).height;
    make_clip(clip, frames > 0 ? frames : kMadeFrames);
    return clip;
  }
  video::VideoReader reader = open_clip(wanted, 0);
  clip.name = std::filesystem::path(wanted).filename().string();
  clip.width = size ? size->width : reader.info().width;
  clip.height = size ? size->height : reader.info().height;
  if (size || frames > 0) {
    store_scaled(reader, clip, frames);
  } else {
    clip.path = wanted;
  }
  return clip;
}

double pass_through(const std::string& input, const std::string& output, const video::WriteOptions& options,
                    int threads) {
  const ThreadCap cap(threads);
  video::VideoReader reader = open_clip(input, threads);
  const auto begin = std::chrono::steady_clock::now();
  auto writer = video::VideoWriter::create(output, reader.info(), options);
  const auto read = [&]() -> std::optional<video::Frame> {
    video::Frame frame;
    if (!reader.next(frame)) return std::nullopt;
    return frame;
  };
  const auto when = threads == 1 ? std::launch::deferred : std::launch::async;
  auto next = std::async(when, read);
  while (const std::optional<video::Frame> frame = next.get()) {
    check_interrupted();
    next = std::async(when, read);
    writer.write(frame->image, frame->pts, frame->duration);
  }
  writer.finish();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace knotreel::cli::bench
