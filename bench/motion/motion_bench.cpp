// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "knotreel/base/parallel.h"
#include "knotreel/motion/cut.h"
#include "knotreel/motion/flow.h"
#include "knotreel/motion/luma.h"
#include "knotreel/motion/measures.h"
#include "knotreel/motion/refine_motion.h"
#include "knotreel/motion/still.h"
#include "knotreel/motion/warp.h"

namespace knotreel::motion {
namespace {

/// RGB with waves of several lengths, moved by d.
image::Image waves(int width, int height, Vec2 d) {
  image::Image picture = image::make_image(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = x - d.x;
      const double v = y - d.y;
      const double value = 128 + 40 * std::sin(0.31 * u + 0.17 * v) + 40 * std::sin(0.05 * u - 0.09 * v) +
                           40 * std::sin(0.11 * u * std::sin(0.01 * v));
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = float(value * (1 - 0.2 * c));
    }
  }
  return picture;
}

/// Two pictures of one scene, and what is known of them.
struct Scene {
  image::Image from;
  image::Image to;
  Luma luma_from;
  Luma luma_to;
  Luma luma_moved;
  FlowPair pair;
};

Scene scene(int width, int height) {
  Scene s{waves(width, height, {}), waves(width, height, {2.5, -1.5}), {}, {}, {}, {}};
  s.luma_from = luma_of(s.from);
  s.luma_to = luma_of(s.to);
  s.pair = find_flow_pair(s.luma_from, s.luma_to);
  s.luma_moved = warp(s.luma_to, s.pair.forward);
  return s;
}

/// Times `work(scene)` at the size of range(0) x range(1), on all threads.
template <typename Work>
void run(benchmark::State& state, const Work& work) {
  const Scene s = scene(int(state.range(0)), int(state.range(1)));
  for (auto _ : state) benchmark::DoNotOptimize(work(s));
}

/// range(2): effort.
void BM_FindFlow(benchmark::State& state) {
  const FlowOptions options{FlowOptions::Effort(state.range(2))};
  run(state, [&](const Scene& s) { return find_flow(s.luma_from, s.luma_to, options); });
}

/// range(2): effort; both directions, the one back turned round, and the consistent pixels.
void BM_FindFlowPair(benchmark::State& state) {
  const FlowOptions options{FlowOptions::Effort(state.range(2)), /*turn_back=*/true};
  run(state, [&](const Scene& s) { return find_flow_pair(s.luma_from, s.luma_to, options); });
}

void BM_Luma(benchmark::State& state) {
  run(state, [](const Scene& s) { return luma_of(s.from); });
}

void BM_Consistent(benchmark::State& state) {
  run(state, [](const Scene& s) { return consistent(s.pair.forward, s.pair.backward); });
}

void BM_Warp(benchmark::State& state) {
  run(state, [](const Scene& s) { return warp(s.to, s.pair.forward); });
}

void BM_WarpLuma(benchmark::State& state) {
  run(state, [](const Scene& s) { return warp(s.luma_to, s.pair.forward); });
}

void BM_Unlikeness(benchmark::State& state) {
  run(state, [](const Scene& s) { return unlikeness(s.luma_from, s.luma_moved); });
}

/// Motion of 2,000 points, and which of them are still.
void BM_Points(benchmark::State& state) {
  std::vector<Vec2> points;
  for (int i = 0; i < 2000; ++i) {
    points.push_back({double(i * 7919 % state.range(0)), double(i * 104729LL % state.range(1))});
  }
  run(state, [&](const Scene& s) {
    const auto motions = point_motion(points, s.pair.forward, s.pair.consistent);
    return still_points(points, motions, s.luma_from, s.luma_to, s.luma_moved);
  });
}

void BM_RefineMotion(benchmark::State& state) {
  std::vector<Vec2> points;
  for (int i = 0; i < 2000; ++i) {
    points.push_back({double(i * 7919 % state.range(0)), double(i * 104729LL % state.range(1))});
  }
  run(state, [&](const Scene& s) {
    std::vector<Vec2> motions(points.size(), Vec2{2.2, -1.3});
    refine_motion(points, motions, s.luma_from, s.luma_to);
    return motions;
  });
}

void BM_Flicker(benchmark::State& state) {
  FlickerMeter meter;
  run(state, [&](const Scene& s) {
    meter.add(s.from, s.to, &s.pair.forward, &s.pair.consistent);
    return meter.per_frame().size();
  });
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->Args({352, 288})->Args({640, 360})->Unit(benchmark::kMillisecond)->UseRealTime();
}

void sizes_and_efforts(benchmark::internal::Benchmark* bench) {
  for (const int effort : {0, 1, 2}) bench->Args({352, 288, effort})->Args({640, 360, effort});
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(BM_FindFlow)->Apply(sizes_and_efforts);
BENCHMARK(BM_FindFlowPair)->Apply(sizes_and_efforts);
BENCHMARK(BM_Luma)->Apply(sizes);
BENCHMARK(BM_Consistent)->Apply(sizes);
BENCHMARK(BM_Warp)->Apply(sizes);
BENCHMARK(BM_WarpLuma)->Apply(sizes);
BENCHMARK(BM_Unlikeness)->Apply(sizes);
BENCHMARK(BM_Points)->Apply(sizes);
BENCHMARK(BM_RefineMotion)->Apply(sizes);
BENCHMARK(BM_Flicker)->Apply(sizes);

}  // namespace
}  // namespace knotreel::motion
