// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>

#include "features/draw.h"
#include "features/gradient.h"
#include "knotreel/base/parallel.h"
#include "knotreel/features/colour_correction.h"
#include "knotreel/features/detect.h"
#include "knotreel/features/fair.h"

namespace knotreel::features {
namespace {

/// Like a photograph in what counts here: 80 discs of all sizes, shading, and a little noise. About 3 % of
/// the pixels are feature pixels.
image::Image bench_picture(int width, int height) {
  image::Image image = image::make_image(width, height, 3);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = float(60 + 60.0 * (x + y) / (width + height));
    }
  }
  for (int disc = 0; disc < 80; ++disc) {
    const Vec2 centre{width * unit(random), height * unit(random)};
    const double radius = 4 + 0.12 * height * std::pow(unit(random), 2);
    const double colour[3] = {255 * unit(random), 255 * unit(random), 255 * unit(random)};
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double cover = std::clamp(radius + 0.5 - norm(Vec2{x + 0.5, y + 0.5} - centre), 0.0, 1.0);
        for (int c = 0; c < 3; ++c) {
          image.at(x, y, c) = float((1 - cover) * double{image.at(x, y, c)} + cover * colour[c]);
        }
      }
    }
  }
  for (float& sample : image.samples) sample += float(4 * unit(random) - 2);
  return image;
}

void report(benchmark::State& state, const FeatureChains& chains) {
  std::size_t points = 0;
  for (const Chain& chain : chains.chains) points += chain.points.size();
  state.counters["chains"] = double(chains.chains.size());
  state.counters["points"] = double(points);
}

/// range(0), range(1): size, range(2): threads.
void BM_Detect(benchmark::State& state) {
  const ThreadCap cap(int(state.range(2)));
  const image::Image image = bench_picture(int(state.range(0)), int(state.range(1)));
  FeatureChains chains;
  for (auto _ : state) chains = detect_features(image);
  report(state, chains);
}

/// The gradients alone, and edge drawing on them alone.
void BM_Gradient(benchmark::State& state) {
  const image::Image image = bench_picture(int(state.range(0)), int(state.range(1)));
  for (auto _ : state) benchmark::DoNotOptimize(make_gradient_field(image, {}).magnitude.data());
}

void BM_DrawEdges(benchmark::State& state) {
  const image::Image image = bench_picture(int(state.range(0)), int(state.range(1)));
  const GradientField field = make_gradient_field(image, {});
  for (auto _ : state) {
    const LinkMap map = draw_edges(field, {});
    benchmark::DoNotOptimize(&map);
  }
}

void BM_Fair(benchmark::State& state) {
  const image::Image image = bench_picture(int(state.range(0)), int(state.range(1)));
  const FeatureChains detected = detect_features(image);
  for (auto _ : state) {
    FeatureChains chains = detected;
    fair_chains(chains);
    benchmark::DoNotOptimize(chains.chains.data());
  }
  report(state, detected);
}

void BM_CorrectColours(benchmark::State& state) {
  const image::Image image = bench_picture(int(state.range(0)), int(state.range(1)));
  const FeatureChains chains = detect_features(image);
  for (auto _ : state) benchmark::DoNotOptimize(correct_colours(image, chains).samples.data());
  report(state, chains);
}

BENCHMARK(BM_Detect)
    ->ArgNames({"width", "height", "threads"})
    ->Args({352, 288, 1})
    ->Args({640, 360, 1})
    ->Args({640, 360, 2})
    ->Args({768, 512, 1})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Gradient)
    ->ArgNames({"width", "height"})
    ->Args({352, 288})
    ->Args({640, 360})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_DrawEdges)
    ->ArgNames({"width", "height"})
    ->Args({352, 288})
    ->Args({640, 360})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Fair)
    ->ArgNames({"width", "height"})
    ->Args({352, 288})
    ->Args({640, 360})
    ->Args({768, 512})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_CorrectColours)
    ->ArgNames({"width", "height"})
    ->Args({352, 288})
    ->Args({640, 360})
    ->Args({768, 512})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace knotreel::features
