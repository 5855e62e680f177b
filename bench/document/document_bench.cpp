// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <span>
#include <sstream>

#include "knotreel/document/reader.h"
#include "knotreel/document/writer.h"
#include "support/bench_mesh.h"

namespace knotreel::document {
namespace {

/// Smooth colours with the noise of a fit, small displacements. range(0): knots.
FrameModel bench_model(const benchmark::State& state) {
  FrameModel model;
  model.space = std::make_shared<const spline::SplineSpace>(
      bench::picture_mesh(640, 360, static_cast<int>(state.range(0)), 8), 2);
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0, 1);
  for (spline::FunctionIndex f = 0; f < model.space->function_count(); ++f) {
    const Vec2 g = model.space->greville(f);
    const double light = 128 + 70 * std::sin(g.x / 37) * std::cos(g.y / 29) + 8 * noise(random);
    for (int c = 0; c < 3; ++c)
      model.colour.push_back(light + 20 * std::sin(g.x / 61 + c) + 2 * noise(random));
  }
  for (std::size_t g = 0; g < model.space->geometry_count(); ++g) {
    model.displacement.push_back({0.1 * noise(random), 0.1 * noise(random)});
  }
  return model;
}

SequenceInfo bench_info() {
  SequenceInfo info;
  info.width = 640;
  info.height = 360;
  return info;
}

/// The next frame with the same topology and new colours everywhere.
FrameModel recoloured(FrameModel model) {
  std::mt19937_64 random(2);
  std::normal_distribution<double> noise(0, 3);
  for (double& c : model.colour) c += noise(random);
  model.keyframe = false;
  ++model.pts;
  return model;
}

std::vector<std::byte> written(const std::vector<FrameModel>& frames) {
  std::ostringstream out;
  EncodeOptions options;
  options.rename_knots = frames.size() == 1;
  Writer writer(out, bench_info(), options);
  for (const FrameModel& f : frames) writer.append(f);
  writer.finish();
  const std::string text = out.str();
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

void report(benchmark::State& state, const FrameModel& model, std::uint64_t bytes) {
  state.counters["knots"] = static_cast<double>(model.space->mesh().knots.size());
  state.counters["control_points"] = static_cast<double>(model.space->function_count());
  state.counters["bytes"] = static_cast<double>(bytes);
  state.counters["raw_bytes"] = static_cast<double>(raw_accounting_bytes(model));
}

/// A keyframe, its knots in an order unlike that of the file.
void BM_EncodeKeyframe(benchmark::State& state) {
  const FrameModel model = bench_model(state);
  for (auto _ : state) benchmark::DoNotOptimize(written({model}).data());
  report(state, model, written({model}).size());
}

/// A frame that keeps the topology, in an encoder loop.
void BM_EncodeDelta(benchmark::State& state) {
  std::ostringstream out;
  Writer writer(out, bench_info());
  FrameModel model = writer.append(bench_model(state));
  std::streamoff before = 0;
  for (auto _ : state) {
    before = out.tellp();
    model = writer.append(recoloured(model));
  }
  report(state, model, static_cast<std::uint64_t>(out.tellp() - before));
}

/// From the file to a spline space with its control points.
void BM_OpenDocument(benchmark::State& state) {
  const FrameModel model = bench_model(state);
  const auto path = std::filesystem::temp_directory_path() / "knotreel_document_bench.tcb";
  {
    EncodeOptions options;
    options.rename_knots = true;
    std::ofstream file(path, std::ios::binary);
    Writer writer(file, bench_info(), options);
    writer.append(model);
    writer.finish();
  }
  for (auto _ : state) benchmark::DoNotOptimize(Reader::open(path).read(0).colour.data());
  report(state, model, std::filesystem::file_size(path));
  std::filesystem::remove(path);
}

/// The frame after a keyframe that has been read.
void BM_DecodeDelta(benchmark::State& state) {
  const FrameModel model = bench_model(state);
  std::vector<FrameModel> frames{model};
  for (int i = 0; i < 64; ++i) frames.push_back(recoloured(frames.back()));
  Reader reader = Reader::open(written(frames));
  std::size_t frame = 0;
  reader.read(0);
  for (auto _ : state) {
    if (++frame == frames.size()) {
      state.PauseTiming();
      reader.read(frame = 0);
      frame = 1;
      state.ResumeTiming();
    }
    benchmark::DoNotOptimize(reader.read(frame).colour.data());
  }
  report(state, model, reader.record(1).bytes);
}

BENCHMARK(BM_EncodeKeyframe)->ArgName("knots")->Arg(400)->Arg(1600)->Arg(4500)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_EncodeDelta)->ArgName("knots")->Arg(1600)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_OpenDocument)->ArgName("knots")->Arg(400)->Arg(1600)->Arg(4500)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_DecodeDelta)->ArgName("knots")->Arg(1600)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace knotreel::document
