// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <random>

#include "knotreel/base/parallel.h"
#include "knotreel/raster/render.h"
#include "support/bench_mesh.h"

namespace knotreel::raster {
namespace {

/// About 3,700 control points on a 640x360 domain, with 20 feature polylines of four segments.
/// @param reach random displacement of control points, in pixels; 0 makes the geometry the identity.
document::FrameModel bench_model(double reach) {
  document::FrameModel model;
  model.space = std::make_shared<const spline::SplineSpace>(bench::picture_mesh(640, 360, 950, 20), 2);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto& mesh = model.space->mesh();
  for (const Vec2 site : model.space->geometry_greville()) {
    const bool on_x = site.x == 0 || site.x == mesh.width;
    const bool on_y = site.y == 0 || site.y == mesh.height;
    model.displacement.push_back({on_x ? 0 : reach * unit(random), on_y ? 0 : reach * unit(random)});
  }
  model.colour.resize(model.space->function_count() * 3);
  for (double& c : model.colour) c = 127 + 127 * unit(random);
  return model;
}

/// range(0): width of the output, range(1): displacement in tenths of a pixel, range(2): threads (0: all).
void BM_Render(benchmark::State& state) {
  const ThreadCap cap(static_cast<int>(state.range(2)));
  const document::FrameModel model = bench_model(0.1 * static_cast<double>(state.range(1)));
  RenderOptions options;
  options.width = static_cast<int>(state.range(0));
  options.height = options.width * 9 / 16;
  constexpr int kBand = 64;
  std::vector<float> band(static_cast<std::size_t>(options.width) * kBand * 3);
  for (auto _ : state) {
    const Renderer renderer(model, options);
    for (int y = 0; y < options.height; y += kBand) {
      const int n = std::min(kBand, options.height - y);
      renderer.rows(y, y + n, std::span(band).first(static_cast<std::size_t>(n * options.width) * 3));
      benchmark::DoNotOptimize(band.data());
    }
  }
  // Of the whole process so far: to read it for one case, run that case alone.
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  state.counters["peak_MB"] = static_cast<double>(usage.ru_maxrss) / 1024;
  state.counters["control points"] = static_cast<double>(model.space->function_count());
  state.SetItemsProcessed(state.iterations() * options.width * options.height);
}

BENCHMARK(BM_Render)
    ->ArgNames({"width", "displacement", "threads"})
    ->Args({640, 0, 0})
    ->Args({640, 5, 0})
    ->Args({3840, 0, 0})
    ->Args({3840, 5, 0})
    ->Args({3840, 5, 1})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace knotreel::raster
