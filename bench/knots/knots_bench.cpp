// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include "knotreel/base/parallel.h"
#include "knotreel/knots/link_choice.h"
#include "knotreel/knots/optimise.h"
#include "knotreel/knots/place.h"
#include "knotreel/knots/refine.h"
#include "knotreel/knots/target.h"
#include "knotreel/mesh/triangulate.h"
#include "support/bench_scene.h"

namespace knotreel::knots {
namespace {

/// A picture of range(0) x range(1) pixels; range(2): threads.
struct Case {
  explicit Case(const benchmark::State& state)
      : cap(int(state.range(2))),
        target(bench::scene_picture(int(state.range(0)), int(state.range(1))), {}) {}

  int width() const { return target.image().width; }
  int height() const { return target.image().height; }

  /// Placed by the picture, about as many knots as frames of videos have.
  mesh::EditableMesh placed() const {
    mesh::KnotMesh domain = mesh::make_domain(width(), height());
    mesh::triangulate(domain);
    mesh::EditableMesh mesh(domain);
    PlaceOptions options;
    options.max_knots = static_cast<std::size_t>(width() * height() / 130);
    insert_knots(mesh, target, options);
    return mesh;
  }

  ThreadCap cap;
  Target target;
};

void BM_Target(benchmark::State& state) {
  const Case c(state);
  for (auto _ : state) benchmark::DoNotOptimize(Target(c.target.image(), {}).channels());
}

/// Constrained Delaunay of all knots at once.
void BM_Triangulate(benchmark::State& state) {
  const Case c(state);
  const mesh::KnotMesh mesh = bench::scene_mesh(c.width(), c.height());
  for (auto _ : state) {
    mesh::KnotMesh copy = mesh;
    mesh::triangulate(copy);
    benchmark::DoNotOptimize(copy.faces.data());
  }
  state.counters["knots"] = double(mesh.knots.size());
}

void BM_Place(benchmark::State& state) {
  const Case c(state);
  std::size_t knots = 0;
  for (auto _ : state) knots = c.placed().knot_count();
  state.counters["knots"] = double(knots);
}

/// One round, as the balanced preset has.
void BM_Optimise(benchmark::State& state) {
  const Case c(state);
  const mesh::EditableMesh placed = c.placed();
  OptimiseOptions options;
  options.rounds = 1;
  options.steps = 4;
  for (auto _ : state) {
    mesh::EditableMesh mesh = placed;
    optimise(mesh, c.target, options);
    benchmark::DoNotOptimize(mesh.knot_count());
  }
  state.counters["knots"] = double(placed.knot_count());
}

/// A space whose links are chosen by the picture, and one of the standard links for comparison (range(3): 0).
void BM_Links(benchmark::State& state) {
  const Case c(state);
  const mesh::KnotMesh mesh = c.placed().to_mesh();
  for (auto _ : state) {
    const spline::SplineSpace space =
        state.range(3) == 0 ? spline::SplineSpace(mesh, 2)
                            : spline::SplineSpace(mesh, 2, picture_links(c.target), spline::LinkOrder::kAny);
    benchmark::DoNotOptimize(space.function_count());
  }
}

/// A tenth of the knots more, where the error is.
void BM_Refine(benchmark::State& state) {
  const Case c(state);
  const mesh::EditableMesh placed = c.placed();
  std::vector<float> errors;
  for (std::size_t i = 0; i < c.target.image().pixel_count(); ++i) errors.push_back(float(i * 7919 % 1000));
  RefineOptions options;
  options.max_knots = placed.knot_count() / 10;
  for (auto _ : state) {
    mesh::EditableMesh mesh = placed;
    benchmark::DoNotOptimize(refine_knots(mesh, errors, {}, c.width(), c.height(), options).size());
  }
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"width", "height", "threads"});
  for (const int threads : {1, 2}) bench->Args({352, 288, threads})->Args({640, 360, threads});
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}

void sizes_and_links(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"width", "height", "threads", "picture"});
  for (const int picture : {0, 1}) bench->Args({352, 288, 1, picture})->Args({640, 360, 1, picture});
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(BM_Target)->Apply(sizes);
BENCHMARK(BM_Triangulate)->Apply(sizes);
BENCHMARK(BM_Place)->Apply(sizes);
BENCHMARK(BM_Optimise)->Apply(sizes);
BENCHMARK(BM_Links)->Apply(sizes_and_links);
BENCHMARK(BM_Refine)->Apply(sizes);

}  // namespace
}  // namespace knotreel::knots
