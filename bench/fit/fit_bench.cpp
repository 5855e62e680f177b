// SPDX-License-Identifier: GPL-3.0-or-later
#include <benchmark/benchmark.h>

#include <Eigen/CholmodSupport>
#include <cmath>
#include <numbers>
#include <random>

#include "fit/colour_steps.h"
#include "fit/normal_equations.h"
#include "fit/reduced_system.h"
#include "knotreel/base/parallel.h"
#include "knotreel/fit/colour_fit.h"
#include "knotreel/fit/geometry_fit.h"
#include "knotreel/fit/knot_gradient.h"
#include "knotreel/fit/pixel_places.h"
#include "knotreel/spline/smooth_corners.h"
#include "support/bench_scene.h"

namespace knotreel::fit {
namespace {

using spline::PixelValues;
using Matrix = Eigen::SparseMatrix<double>;
using Factor = Eigen::CholmodSimplicialLDLT<Matrix, Eigen::Lower>;

/// A picture of range(0) x range(1) pixels and a space over it; range(2): threads.
struct Case {
  explicit Case(const benchmark::State& state)
      : cap(int(state.range(2))),
        picture(bench::scene_picture(int(state.range(0)), int(state.range(1)))),
        space(
            std::make_shared<const spline::SplineSpace>(bench::scene_mesh(picture.width, picture.height), 2)),
        basis(space) {}

  PixelValues values() const { return {basis, picture.width, picture.height, {}}; }
  Pixels pixels() const { return {.image = &picture}; }

  /// With the ridge that makes them definite.
  NormalEquations normal(const PixelValues& at) const {
    NormalEquations equations = assemble<double>(at, picture, {});
    const double ridge = ColourFitOptions{}.ridge * equations.matrix.diagonal().maxCoeff();
    for (Eigen::Index i = 0; i < equations.matrix.rows(); ++i) equations.matrix.coeffRef(i, i) += ridge;
    return equations;
  }

  ThreadCap cap;
  image::Image picture;
  std::shared_ptr<const spline::SplineSpace> space;
  spline::Basis basis;
};

/// Times `work(case)`.
template <typename Work>
void run(benchmark::State& state, const Work& work) {
  const Case c(state);
  state.counters["control points"] = double(c.space->function_count());
  work(c);
}

/// Which functions reach which tiles.
void BM_MakePixelValues(benchmark::State& state) {
  run(state, [&](const Case& c) {
    for (auto _ : state) benchmark::DoNotOptimize(c.values().tile_count());
  });
}

/// All basis functions at all pixels, in a precision.
template <typename Value>
void BM_PixelValues(benchmark::State& state) {
  run(state, [&](const Case& c) {
    std::vector<Value> at;
    const PixelValues values = c.values();
    for (auto _ : state) {
      for (std::size_t t = 0; t < values.tile_count(); ++t) {
        at.resize(values.functions(t).size() * PixelValues::kTilePixels);
        values.evaluate(t, at.data());
        benchmark::DoNotOptimize(at.data());
      }
    }
  });
}

template <typename Value>
void BM_Assemble(benchmark::State& state) {
  run(state, [&](const Case& c) {
    const PixelValues values = c.values();
    for (auto _ : state) benchmark::DoNotOptimize(assemble<Value>(values, c.picture, {}).matrix.nonZeros());
  });
}

/// The order of elimination alone, which depends on the links only.
void BM_Analyse(benchmark::State& state) {
  run(state, [&](const Case& c) {
    const Matrix matrix = c.normal(c.values()).matrix;
    for (auto _ : state) {
      Factor factor;
      factor.analyzePattern(matrix);
      benchmark::DoNotOptimize(factor.info());
    }
  });
}

void BM_Factor(benchmark::State& state) {
  run(state, [&](const Case& c) {
    const Matrix matrix = c.normal(c.values()).matrix;
    Factor factor;
    factor.analyzePattern(matrix);
    for (auto _ : state) {
      factor.factorize(matrix);
      benchmark::DoNotOptimize(factor.info());
    }
  });
}

/// Three channels, with the factor there.
void BM_Resolve(benchmark::State& state) {
  run(state, [&](const Case& c) {
    const NormalEquations normal = c.normal(c.values());
    const Factor factor(normal.matrix);
    for (auto _ : state) {
      const Eigen::MatrixXd solution = factor.solve(normal.right);
      benchmark::DoNotOptimize(solution.data());
    }
  });
}

/// Analysis, factor and solution with corner smoothing, as the colour fit does it.
void BM_SolveReduced(benchmark::State& state) {
  run(state, [&](const Case& c) {
    const NormalEquations normal = c.normal(c.values());
    const Matrix p = spline::smooth_corner_prolongation(*c.space, spline::SharedFunctions::kFree);
    for (auto _ : state) benchmark::DoNotOptimize(solve_reduced(normal.matrix, p, normal.right).data());
  });
}

/// The same from a solution that is wrong by up to two levels, as in warm frames.
void BM_SolveReducedFromNearby(benchmark::State& state) {
  run(state, [&](const Case& c) {
    const NormalEquations normal = c.normal(c.values());
    const Matrix p = spline::smooth_corner_prolongation(*c.space, spline::SharedFunctions::kFree);
    Eigen::MatrixXd start = solve_reduced(normal.matrix, p, normal.right);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> wrong(-2, 2);
    for (double& x : start.reshaped()) x += wrong(random);
    for (auto _ : state)
      benchmark::DoNotOptimize(solve_reduced(normal.matrix, p, normal.right, start).data());
  });
}

/// Three channels to multiples of 3 levels, from a solution, with control points before that were a little
/// off.
void BM_ColourSteps(benchmark::State& state) {
  run(state, [&](const Case& c) {
    const NormalEquations normal = c.normal(c.values());
    const Matrix p = spline::smooth_corner_prolongation(*c.space, spline::SharedFunctions::kFree);
    const Eigen::MatrixXd solution = solve_reduced(normal.matrix, p, normal.right);
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> by_row = solution;
    const std::vector<double> start(by_row.data(), by_row.data() + by_row.size());
    std::vector<double> before = start;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> wrong(-2, 2);
    for (double& x : before) x += wrong(random);
    const std::vector<double> reluctance(static_cast<std::size_t>(solution.rows()), 0.4);
    const std::vector<std::uint8_t> moving(static_cast<std::size_t>(solution.rows()), 1);
    for (auto _ : state) {
      std::vector<double> control = start;
      descend_in_steps(normal.matrix, normal.right, moving, before, {.step = 3, .reluctance = reluctance},
                       control);
      benchmark::DoNotOptimize(control.data());
    }
  });
}

/// All of it but the values of the basis functions.
template <Precision kPrecision>
void BM_FitColours(benchmark::State& state) {
  run(state, [&](const Case& c) {
    const PixelValues values = c.values();
    const ColourFitOptions options{.precision = kPrecision};
    for (auto _ : state) benchmark::DoNotOptimize(fit_colours(values, c.pixels(), options).control.data());
  });
}

void BM_KnotGradient(benchmark::State& state) {
  run(state, [&](const Case& c) {
    const ColourFit fit = fit_colours(c.values(), c.pixels());
    for (auto _ : state) benchmark::DoNotOptimize(knot_gradient(c.values(), c.pixels(), fit).data());
  });
}

/// Pixels in a third of the picture are displaced, up to two pixels.
std::vector<Vec2> displaced_places(const image::Image& picture) {
  std::vector<Vec2> places;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double inside = std::max(0.0, std::sin(9.0 * x / picture.width) - 0.4) *
                            std::sin(std::numbers::pi * y / picture.height);
      places.push_back({x + 0.5 + 2 * inside, y + 0.5});
    }
  }
  return places;
}

void BM_FitGeometry(benchmark::State& state) {
  run(state, [&](const Case& c) {
    const std::vector<Vec2> places = displaced_places(c.picture);
    const PixelValues values(c.basis, c.picture.width, c.picture.height, places);
    for (auto _ : state) benchmark::DoNotOptimize(fit_geometry(values, places, {}).data());
  });
}

void BM_PixelPlaces(benchmark::State& state) {
  run(state, [&](const Case& c) {
    const std::vector<Vec2> places = displaced_places(c.picture);
    const PixelValues values(c.basis, c.picture.width, c.picture.height, places);
    const std::vector<Vec2> displacement = fit_geometry(values, places, {});
    for (auto _ : state) {
      const auto found = pixel_places(c.basis, displacement, c.picture.width, c.picture.height);
      benchmark::DoNotOptimize(found.data());
    }
  });
}

void sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"width", "height", "threads"});
  for (const int threads : {1, 2}) bench->Args({352, 288, threads})->Args({640, 360, threads});
  bench->Unit(benchmark::kMillisecond)->UseRealTime();
}

BENCHMARK(BM_MakePixelValues)->Apply(sizes);
BENCHMARK(BM_PixelValues<float>)->Apply(sizes);
BENCHMARK(BM_PixelValues<double>)->Apply(sizes);
BENCHMARK(BM_Assemble<float>)->Apply(sizes);
BENCHMARK(BM_Assemble<double>)->Apply(sizes);
BENCHMARK(BM_Analyse)->Apply(sizes);
BENCHMARK(BM_Factor)->Apply(sizes);
BENCHMARK(BM_Resolve)->Apply(sizes);
BENCHMARK(BM_SolveReduced)->Apply(sizes);
BENCHMARK(BM_SolveReducedFromNearby)->Apply(sizes);
BENCHMARK(BM_ColourSteps)->Apply(sizes);
BENCHMARK(BM_FitColours<Precision::kSingle>)->Apply(sizes);
BENCHMARK(BM_FitColours<Precision::kDouble>)->Apply(sizes);
BENCHMARK(BM_KnotGradient)->Apply(sizes);
BENCHMARK(BM_FitGeometry)->Apply(sizes);
BENCHMARK(BM_PixelPlaces)->Apply(sizes);

}  // namespace
}  // namespace knotreel::fit
