// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include <cstdint>
#include <random>

#include "knotreel/base/parallel.h"
#include "knotreel/features/image_mesh.h"
#include "knotreel/param/parametrization.h"
#include "knotreel/param/parametrized_image.h"
#include "param/multigrid.h"
#include "support/chains.h"

namespace knotreel::param {
namespace {

/// About 100 chains and 5,000 pixels at 640x360, as in a typical photo.
features::FeatureChains bench_chains(int width, int height) {
  return testing::random_chains(width, height, width * height / 2100, 3);
}

std::size_t chain_pixels(const features::FeatureChains& chains) {
  std::size_t count = 0;
  for (const features::Chain& c : chains.chains) count += c.points.size();
  return count;
}

/// range(0), range(1): size; range(2): threads (0: all).
void BM_Solve(benchmark::State& state) {
  const ThreadCap cap(static_cast<int>(state.range(2)));
  const int width = static_cast<int>(state.range(0));
  const int height = static_cast<int>(state.range(1));
  const auto chains = bench_chains(width, height);
  const auto mesh = features::make_image_mesh(chains);
  const Parametrization p = parametrize(chains, mesh);
  std::vector<std::uint8_t> fixed(p.position.size(), 0);
  std::vector<std::int32_t> given;
  Framed<Quad> start(width, height);
  for (const CurveSample& s : p.curve_samples) {
    if (s.pixel == kNoPixel) continue;
    const auto pixel = static_cast<std::size_t>(s.pixel);
    fixed[pixel] = 1;
    given.push_back(s.pixel);
    const int x = s.pixel % width;
    const int y = s.pixel / width;
    const Vec2 f = p.position[pixel] - Vec2{x + 0.5, y + 0.5};
    const Vec2 d = p.parameter[pixel] - Vec2{x + 0.5, y + 0.5};
    start.at(x, y) = Quad{static_cast<float>(f.x), static_cast<float>(f.y), static_cast<float>(d.x),
                          static_cast<float>(d.y)};
  }
  int cycles = 0;
  for (auto _ : state) {
    Framed<Quad> field = start;
    ScreenedTutte solver(width, height, fixed, ParametrizeOptions{}.decay);
    cycles = solver.solve(field, ParametrizeOptions{}.tolerance, given);
    benchmark::DoNotOptimize(field.at(0, 0));
  }
  state.counters["cycles"] = cycles;
}

void BM_Parametrize(benchmark::State& state) {
  const ThreadCap cap(static_cast<int>(state.range(2)));
  const auto chains = bench_chains(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const auto mesh = features::make_image_mesh(chains);
  ParametrizeReport report;
  for (auto _ : state) benchmark::DoNotOptimize(parametrize(chains, mesh, {}, &report));
  state.counters["chains"] = static_cast<double>(chains.chains.size());
  state.counters["pixels"] = static_cast<double>(chain_pixels(chains));
  state.counters["cycles"] = report.cycles;
  state.counters["rounds"] = report.rounds;
}

void BM_ParametrizedImage(benchmark::State& state) {
  const ThreadCap cap(static_cast<int>(state.range(2)));
  const auto chains = bench_chains(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const auto mesh = features::make_image_mesh(chains);
  const Parametrization p = parametrize(chains, mesh);
  image::Image picture = image::make_image(chains.width, chains.height, 3);
  std::mt19937 random(1);
  for (float& s : picture.samples) s = static_cast<float>(random() & 255);
  for (auto _ : state) benchmark::DoNotOptimize(parametrized_image(picture, chains, mesh, p));
}

void sizes(benchmark::internal::Benchmark* b) {
  for (const int threads : {1, 0}) {
    b->Args({352, 288, threads})->Args({640, 360, threads})->Args({768, 512, threads});
  }
  b->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(BM_Solve)->Apply(sizes);
BENCHMARK(BM_Parametrize)->Apply(sizes);
BENCHMARK(BM_ParametrizedImage)->Apply(sizes);

}  // namespace
}  // namespace knotreel::param
