// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "knotreel/base/parallel.h"
#include "knotreel/fit/colour_fit.h"
#include "knotreel/fit/knot_gradient.h"
#include "knotreel/motion/luma.h"
#include "knotreel/track/carry_mesh.h"
#include "knotreel/track/tracker.h"
#include "support/allocations.h"
#include "support/bench_scene.h"
#include "track/settle.h"
#include "track/snap.h"
#include "track/temporal_target.h"

namespace knotreel::track {
namespace {

vectorize::Options cold_options(const image::Image& picture) {
  vectorize::Options options = vectorize::preset_options(vectorize::Preset::kBalanced);
  options.max_control_points = picture.pixel_count() / 50;
  return options;
}

/// Two pictures of range(0) x range(1) pixels, and the model of the first; range(2): threads.
struct Case {
  explicit Case(const benchmark::State& state)
      : cap(int(state.range(2))),
        before(bench::scene_picture(int(state.range(0)), int(state.range(1)), 0)),
        now(bench::scene_picture(before.width, before.height, 1)),
        motion(motion_between(before, now)),
        model(Tracker(cold_options(before), {}).next(before, nullptr)),
        basis(model.space),
        moves(motion::point_motion(positions(mesh()), motion.flow.forward, motion.flow.consistent)) {}

  static std::vector<Vec2> positions(const mesh::KnotMesh& mesh) {
    std::vector<Vec2> points;
    for (const mesh::Knot& k : mesh.knots) points.push_back(k.position);
    return points;
  }
  const mesh::KnotMesh& mesh() const { return model.space->mesh(); }

  ThreadCap cap;
  image::Image before;
  image::Image now;
  Motion motion;
  document::FrameModel model;
  spline::Basis basis;
  std::vector<Vec2> moves;
};

void BM_CarryMesh(benchmark::State& state) {
  const Case c(state);
  const std::vector<Vec2> targets = knot_targets(c.mesh(), c.moves);
  for (auto _ : state) benchmark::DoNotOptimize(carry_mesh(c.mesh(), targets).faces.data());
  state.counters["knots"] = double(c.mesh().knots.size());
}

void BM_Snap(benchmark::State& state) {
  const Case c(state);
  for (auto _ : state) {
    const SnapResult snapped = snap_to_edges(c.basis, c.model.displacement, c.mesh(), c.moves, c.before,
                                             *c.motion.before, *c.motion.now);
    benchmark::DoNotOptimize(snapped.moves.data());
  }
  state.counters["segments"] = double(c.mesh().segments.size());
}

/// The gradient and a step of every knot.
void BM_Settle(benchmark::State& state) {
  const Case c(state);
  const fit::Pixels pixels{.image = &c.before};
  const fit::ColourFit fit = fit::fit_colours(c.basis, pixels);
  Settling settling{SettleOptions{}};
  for (auto _ : state) {
    const spline::PixelValues values(c.basis, c.before.width, c.before.height, {});
    benchmark::DoNotOptimize(settling.moves(c.mesh(), fit::knot_gradient(values, pixels, fit), 0).data());
  }
}

void BM_TemporalTarget(benchmark::State& state) {
  const Case c(state);
  const std::vector<float> residual(c.before.samples.size(), 1.0F);
  for (auto _ : state) {
    benchmark::DoNotOptimize(temporal_target(c.now, residual, {}, c.motion, 0.5).samples.data());
  }
}

/// A whole frame from its picture alone.
void BM_ColdFrame(benchmark::State& state) {
  const ThreadCap cap(int(state.range(2)));
  const image::Image picture = bench::scene_picture(int(state.range(0)), int(state.range(1)));
  for (auto _ : state) {
    Tracker tracker(cold_options(picture), {});
    benchmark::DoNotOptimize(tracker.next(picture, nullptr).colour.data());
  }
}

/// A whole frame from the frame before, flow not included. range(3): whether anything moves (if not, one
/// pixel changes a little, since repeated pictures are not looked at). The scene goes to and fro, so that it
/// does not end.
void BM_WarmFrame(benchmark::State& state) {
  constexpr int kPictures = 10;  // no cut among them
  const ThreadCap cap(int(state.range(2)));
  const bool moving = state.range(3) != 0;
  const int pictures = moving ? kPictures : 2;
  std::vector<image::Image> scene;
  for (int i = 0; i < pictures; ++i) {
    scene.push_back(bench::scene_picture(int(state.range(0)), int(state.range(1)), moving ? i : 0));
    scene.back().samples[0] += float(i);
  }
  std::vector<int> order;
  for (int i = 0; i < pictures; ++i) order.push_back(i);
  for (int i = pictures - 2; i > 0; --i) order.push_back(i);
  const auto at = [&](std::size_t i) -> const image::Image& {
    return scene[std::size_t(order[i % order.size()])];
  };
  std::vector<Motion> motions;  // from the one before to the i-th of the order
  for (std::size_t i = 0; i < order.size(); ++i)
    motions.push_back(motion_between(at(i + order.size() - 1), at(i)));

  TrackOptions options;
  options.keyframe_interval = 1000000;
  Tracker tracker(cold_options(scene.front()), options);
  tracker.next(scene.front(), nullptr);
  std::size_t frame = 0;
  std::size_t cold = 0;
  FrameReport report;
  const bench::Allocations before = bench::allocations();
  for (auto _ : state) {
    ++frame;
    benchmark::DoNotOptimize(tracker.next(at(frame), &motions[frame % order.size()], &report).colour.data());
    cold += report.start != Start::kWarm;
  }
  const bench::Allocations after = bench::allocations();
  const auto per_frame = [&](std::uint64_t total) { return double(total) / double(frame); };
  state.counters["allocations"] = per_frame(after.calls - before.calls);
  state.counters["allocated MB"] = per_frame(after.bytes - before.bytes) / 1e6;
  state.counters["cold"] = double(cold);
  state.counters["control points"] = double(report.control_points);
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"width", "height", "threads"});
  for (const int threads : {1, 2}) bench->Args({352, 288, threads})->Args({640, 360, threads});
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}

void sizes_still_and_moving(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"width", "height", "threads", "moving"});
  for (const int moving : {0, 1}) {
    for (const int threads : {1, 2}) {
      bench->Args({352, 288, threads, moving})->Args({640, 360, threads, moving});
    }
  }
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(BM_CarryMesh)->Apply(sizes);
BENCHMARK(BM_Snap)->Apply(sizes);
BENCHMARK(BM_Settle)->Apply(sizes);
BENCHMARK(BM_TemporalTarget)->Apply(sizes);
BENCHMARK(BM_ColdFrame)->Apply(sizes);
BENCHMARK(BM_WarmFrame)->Apply(sizes_still_and_moving)->Iterations(18);  // there and back

}  // namespace
}  // namespace knotreel::track
