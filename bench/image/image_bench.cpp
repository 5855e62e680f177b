// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "knotreel/base/parallel.h"
#include "knotreel/image/enlarge.h"
#include "knotreel/image/metrics.h"
#include "knotreel/image/resize.h"
#include "support/bench_scene.h"

namespace knotreel::image {
namespace {

/// MEC, RMSE, PSNR and SSIM of a frame of range(0) x range(1) pixels against the next; range(2): threads.
void BM_CompareImages(benchmark::State& state) {
  const ThreadCap cap(int(state.range(2)));
  const Image a = bench::scene_picture(int(state.range(0)), int(state.range(1)), 0);
  const Image b = bench::scene_picture(int(state.range(0)), int(state.range(1)), 1);
  for (auto _ : state) benchmark::DoNotOptimize(compare_images(a, b).ssim);
}

/// To twice the size.
void BM_Resize(benchmark::State& state) {
  const ThreadCap cap(int(state.range(2)));
  const Image a = bench::scene_picture(int(state.range(0)), int(state.range(1)), 0);
  for (auto _ : state) benchmark::DoNotOptimize(resize(a, 2 * a.width, 2 * a.height).samples.data());
}

/// For the fine grid.
void BM_EnlargeTwofold(benchmark::State& state) {
  const ThreadCap cap(int(state.range(2)));
  const Image a = bench::scene_picture(int(state.range(0)), int(state.range(1)), 0);
  for (auto _ : state) benchmark::DoNotOptimize(enlarge_twofold(a).samples.data());
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"width", "height", "threads"});
  for (const int threads : {1, 2}) bench->Args({352, 288, threads})->Args({640, 360, threads});
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(BM_CompareImages)->Apply(sizes);
BENCHMARK(BM_Resize)->Apply(sizes);
BENCHMARK(BM_EnlargeTwofold)->Apply(sizes)->Args({1280, 720, 1});

}  // namespace
}  // namespace knotreel::image
