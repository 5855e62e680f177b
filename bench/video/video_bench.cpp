// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include <filesystem>

#include "knotreel/base/parallel.h"
#include "knotreel/video/reader.h"
#include "knotreel/video/writer.h"
#include "support/bench_scene.h"

namespace knotreel::video {
namespace {

constexpr int kFrames = 24;

WriteOptions h264(int threads) {
  WriteOptions options;
  options.codec = "h264";
  options.threads = threads;
  return options;
}

std::vector<image::Image> scene(int width, int height) {
  std::vector<image::Image> pictures;
  for (int i = 0; i < kFrames; ++i) pictures.push_back(bench::scene_picture(width, height, i));
  return pictures;
}

void write_all(const std::string& path, const std::vector<image::Image>& pictures, int threads) {
  StreamInfo info;
  info.width = pictures.front().width;
  info.height = pictures.front().height;
  info.pixel_format = "yuv420p";
  VideoWriter writer = VideoWriter::create(path, info, h264(threads));
  for (int i = 0; i < kFrames; ++i) writer.write(pictures[std::size_t(i)], i, 1);
  writer.finish();
}

std::string temporary_file() {
  return (std::filesystem::temp_directory_path() / "knotreel_video_bench.mkv").string();
}

/// H.264 of range(0) x range(1) pixels to pictures, all frames; range(2): threads.
void BM_Decode(benchmark::State& state) {
  const ThreadCap cap(int(state.range(2)));
  const std::string path = temporary_file();
  write_all(path, scene(int(state.range(0)), int(state.range(1))), 0);
  ReadOptions options;
  options.threads = int(state.range(2));
  Frame frame;
  for (auto _ : state) {
    VideoReader reader = VideoReader::open(path, options);
    while (reader.next(frame)) benchmark::DoNotOptimize(frame.image.samples.data());
  }
  state.SetItemsProcessed(state.iterations() * kFrames);
  std::filesystem::remove(path);
}

/// And back, with the options that transcode has by default.
void BM_Encode(benchmark::State& state) {
  const ThreadCap cap(int(state.range(2)));
  const std::string path = temporary_file();
  const auto pictures = scene(int(state.range(0)), int(state.range(1)));
  for (auto _ : state) write_all(path, pictures, int(state.range(2)));
  state.SetItemsProcessed(state.iterations() * kFrames);
  std::filesystem::remove(path);
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"width", "height", "threads"});
  for (const int threads : {1, 2}) bench->Args({352, 288, threads})->Args({640, 360, threads});
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(BM_Decode)->Apply(sizes);
BENCHMARK(BM_Encode)->Apply(sizes);

}  // namespace
}  // namespace knotreel::video
