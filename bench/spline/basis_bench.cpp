// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include <random>

#include "knotreel/spline/pixel_values.h"
#include "support/bench_mesh.h"

namespace knotreel::spline {
namespace {

/// range(0): degree, range(1): knots, range(2): feature polylines.
std::shared_ptr<const SplineSpace> bench_space(const benchmark::State& state) {
  return std::make_shared<const SplineSpace>(
      bench::picture_mesh(640, 360, static_cast<int>(state.range(1)), static_cast<int>(state.range(2))),
      static_cast<int>(state.range(0)));
}

void report(benchmark::State& state, const SplineSpace& space) {
  state.counters["knots"] = static_cast<double>(space.mesh().knots.size());
  state.counters["functions"] = static_cast<double>(space.function_count());
}

void BM_BuildSpace(benchmark::State& state) {
  const auto space = bench_space(state);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        SplineSpace::from_link_codes(space->mesh(), space->degree(), space->link_codes()).function_count());
  }
  report(state, *space);
}

void BM_MakePieces(benchmark::State& state) {
  const auto space = bench_space(state);
  for (auto _ : state) benchmark::DoNotOptimize(Basis(space).pieces().terms.size());
  report(state, *space);
}

/// All basis functions at all pixel centres of a 640x360 frame, one thread.
void BM_EvaluateGrid(benchmark::State& state) {
  const auto space = bench_space(state);
  const Basis basis(space);
  for (auto _ : state) {
    const PixelValues pixels(basis, 640, 360, {});
    std::vector<double> values;
    for (std::size_t t = 0; t < pixels.tile_count(); ++t) {
      values.resize(pixels.functions(t).size() * PixelValues::kTilePixels);
      pixels.evaluate(t, values.data());
      benchmark::DoNotOptimize(values.data());
    }
  }
  report(state, *space);
}

/// The paper's step, the recurrence with no sharing, at one pixel in a thousand; scale by 1000 to compare.
void BM_EvaluateGridByRecurrence(benchmark::State& state) {
  const auto space = bench_space(state);
  const ReferenceBasis reference(*space);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (auto _ : state) {
    for (int i = 0; i < 230; ++i) {
      benchmark::DoNotOptimize(reference.evaluate_all({unit(random) * 640, unit(random) * 360}).data());
    }
  }
  report(state, *space);
}

void BM_EvaluatePoint(benchmark::State& state) {
  const auto space = bench_space(state);
  const Basis basis(space);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<BasisValue> values;
  for (auto _ : state) {
    basis.evaluate({unit(random) * 640, unit(random) * 360}, values);
    benchmark::DoNotOptimize(values.data());
  }
  report(state, *space);
}

void cases(benchmark::internal::Benchmark* b) {
  b->ArgNames({"degree", "knots", "features"});
  for (const int degree : {1, 2, 3}) b->Args({degree, 1400, 0});
  b->Args({2, 1100, 20});
  b->Unit(benchmark::kMillisecond);
}

BENCHMARK(BM_BuildSpace)->Apply(cases);
BENCHMARK(BM_MakePieces)->Apply(cases);
BENCHMARK(BM_EvaluateGrid)->Apply(cases);
BENCHMARK(BM_EvaluateGridByRecurrence)->Apply(cases);
BENCHMARK(BM_EvaluatePoint)->Apply(cases)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace knotreel::spline
