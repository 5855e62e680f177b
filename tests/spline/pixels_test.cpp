// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/spline/pixel_values.h"
#include "knotreel/spline/surface.h"
#include "spline/law_cases.h"
#include "spline/tent.h"

/// Basis functions at pixels with places of their own, against evaluation point by point.
namespace knotreel::spline {
namespace {

using knotreel::testing::MeshCase;

constexpr std::uint64_t kPixelsSeed = 20260404;

struct Raster {
  int columns;
  int rows;

  std::size_t size() const { return std::size_t(columns) * std::size_t(rows); }
  Vec2 centre(const mesh::KnotMesh& mesh, std::size_t i) const {
    return {(static_cast<double>(i % std::size_t(columns)) + 0.5) * (mesh.width / columns),
            (static_cast<double>(i / std::size_t(columns)) + 0.5) * (mesh.height / rows)};
  }
};

std::vector<Vec2> centres(const mesh::KnotMesh& mesh, const Raster& raster) {
  std::vector<Vec2> places(raster.size());
  for (std::size_t i = 0; i < places.size(); ++i) places[i] = raster.centre(mesh, i);
  return places;
}

/// The left third at the centres, the rest a mixture of centres and places up to two pixels away; and some
/// pixels on knots, edges, features and the border.
std::vector<Vec2> mixed_places(const mesh::KnotMesh& mesh, const Raster& raster) {
  std::mt19937_64 random(kPixelsSeed);
  std::uniform_real_distribution<double> unit(-2, 2);
  std::vector<Vec2> places = centres(mesh, raster);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].x < mesh.width / 3 || random() % 3 == 0) continue;
    places[i] = {std::clamp(places[i].x + unit(random), 0.0, mesh.width),
                 std::clamp(places[i].y + unit(random), 0.0, mesh.height)};
  }
  for (const Vec2 p : knotreel::testing::probe_points(mesh, kPixelsSeed, 0)) {
    if (p.x < mesh.width / 3) continue;
    const int x = std::min(raster.columns - 1, static_cast<int>(p.x * raster.columns / mesh.width));
    const int y = std::min(raster.rows - 1, static_cast<int>(p.y * raster.rows / mesh.height));
    places[std::size_t(y) * std::size_t(raster.columns) + std::size_t(x)] = p;
  }
  return places;
}

/// Pixel by pixel, all functions.
std::vector<double> dense(const PixelValues& pixels) {
  const std::size_t count = pixels.basis().space().function_count();
  const auto width = static_cast<std::size_t>(pixels.width());
  std::vector<double> out(width * static_cast<std::size_t>(pixels.height()) * count);
  std::vector<double> values;
  for (std::size_t t = 0; t < pixels.tile_count(); ++t) {
    const PixelValues::Tile tile = pixels.tile(t);
    const auto functions = pixels.functions(t);
    values.assign(functions.size() * PixelValues::kTilePixels, 1e9);
    pixels.evaluate(t, values.data());
    for (std::size_t f = 0; f < functions.size(); ++f) {
      for (std::size_t i = 0; i < PixelValues::kTilePixels; ++i) {
        const std::size_t x = std::size_t(tile.left) + i % PixelValues::kSide;
        const std::size_t y = std::size_t(tile.top) + i / PixelValues::kSide;
        const double value = values[f * PixelValues::kTilePixels + i];
        if (x < std::size_t(tile.right) && y < std::size_t(tile.bottom)) {
          out[(y * width + x) * count + functions[f]] = value;
        } else {
          EXPECT_EQ(value, 0) << "beside the picture";
        }
      }
    }
  }
  return out;
}

class Pixels : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, Pixels, ::testing::Values(1, 2, 3));

/// @param places none: at the centres.
void expect_values_of_points(const MeshCase& c, int degree, const Raster& raster,
                             const std::vector<Vec2>& places, double tolerance) {
  const Basis basis(std::make_shared<const SplineSpace>(c.mesh, degree));
  const std::size_t n = basis.space().function_count();
  std::vector<double> difference = dense(PixelValues(basis, raster.columns, raster.rows, places));
  std::vector<BasisValue> values;
  double worst = 0;
  Vec2 worst_at;
  for (std::size_t i = 0; i < raster.size(); ++i) {
    const Vec2 u = places.empty() ? raster.centre(c.mesh, i) : places[i];
    basis.evaluate(u, values);
    for (const BasisValue& v : values) difference[i * n + v.function] -= v.value;
    for (std::size_t f = 0; f < n; ++f) {
      if (std::abs(difference[i * n + f]) <= worst || std::isnan(worst)) continue;
      worst = std::abs(difference[i * n + f]);
      worst_at = u;
    }
  }
  EXPECT_LE(worst, tolerance) << "at " << worst_at.x << ' ' << worst_at.y << '\n' << c.to_text();
}

/// Pixels need not be square.
Raster flat_raster(const MeshCase& c) {
  return {static_cast<int>(c.mesh.width), static_cast<int>(c.mesh.height) / 2};
}

TEST_P(Pixels, ValuesAreThoseAtTheirPlaces) {
  for (const MeshCase& c : knotreel::testing::law_cases(kPixelsSeed, 40)) {
    SCOPED_TRACE(c.name);
    expect_values_of_points(c, GetParam(), flat_raster(c), mixed_places(c.mesh, flat_raster(c)), 1e-11);
  }
}

TEST_P(Pixels, ValuesAtTheCentresAreThoseOfPoints) {
  for (const MeshCase& c : knotreel::testing::law_cases(kPixelsSeed, 60)) {
    SCOPED_TRACE(c.name);
    expect_values_of_points(c, GetParam(), flat_raster(c), {}, 1e-10);
  }
}

/// Some cases have faces a few thousandths of a pixel wide; without them it is 2e-5.
TEST_P(Pixels, SinglePrecisionIsNear) {
  double worst = 0;
  for (const MeshCase& c : knotreel::testing::law_cases(kPixelsSeed, 60)) {
    SCOPED_TRACE(c.to_text());
    const Basis basis(std::make_shared<const SplineSpace>(c.mesh, GetParam()));
    const Raster raster = flat_raster(c);
    const std::vector<Vec2> places = mixed_places(c.mesh, raster);
    const PixelValues pixels(basis, raster.columns, raster.rows, places);
    std::vector<double> values;
    std::vector<float> single;
    for (std::size_t t = 0; t < pixels.tile_count(); ++t) {
      values.assign(pixels.functions(t).size() * PixelValues::kTilePixels, 1e9);
      single.assign(values.size(), 1e9F);
      pixels.evaluate(t, values.data());
      pixels.evaluate(t, single.data());
      for (std::size_t i = 0; i < values.size(); ++i)
        worst = std::max(worst, std::abs(values[i] - static_cast<double>(single[i])));
    }
    ASSERT_LE(worst, 1e-3);
  }
  EXPECT_GT(worst, 0);
}

TEST_P(Pixels, PlacesAtTheCentresAreLikeNone) {
  for (const MeshCase& c : knotreel::testing::law_cases(kPixelsSeed, 5)) {
    SCOPED_TRACE(c.name);
    const Basis basis(std::make_shared<const SplineSpace>(c.mesh, GetParam()));
    const Raster raster{static_cast<int>(c.mesh.width), static_cast<int>(c.mesh.height)};
    const std::vector<Vec2> places = centres(c.mesh, raster);
    EXPECT_EQ(dense(PixelValues(basis, raster.columns, raster.rows, {})),
              dense(PixelValues(basis, raster.columns, raster.rows, places)));
  }
}

TEST_P(Pixels, FunctionsThatAreNotWantedAreNowhere) {
  for (const MeshCase& c : knotreel::testing::law_cases(kPixelsSeed, 5)) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    const Raster raster{61, 53};
    const std::vector<Vec2> places = mixed_places(c.mesh, raster);
    const std::size_t n = space->function_count();
    std::vector<std::uint8_t> wanted(n);
    for (std::size_t f = 0; f < n; ++f) wanted[f] = f % 3 == 0;
    const PixelValues some(basis, raster.columns, raster.rows, places, wanted);
    std::vector<double> expected = dense(PixelValues(basis, raster.columns, raster.rows, places));
    for (std::size_t i = 0; i < expected.size(); ++i) expected[i] = wanted[i % n] ? expected[i] : 0;
    EXPECT_EQ(dense(some), expected);
    for (std::size_t t = 0; t < some.tile_count(); ++t) {
      for (const FunctionIndex f : some.functions(t)) EXPECT_TRUE(wanted[f]) << "function " << f;
    }
  }
}

TEST_P(Pixels, ThreadsDoNotMatter) {
  for (const MeshCase& c : knotreel::testing::law_cases(kPixelsSeed, 5)) {
    SCOPED_TRACE(c.name);
    const Basis basis(std::make_shared<const SplineSpace>(c.mesh, GetParam()));
    const Raster raster{61, 53};
    const std::vector<Vec2> places = mixed_places(c.mesh, raster);
    std::vector<double> values[2];
    for (const int threads : {1, 2}) {
      const ThreadCap cap(threads);
      values[threads - 1] = dense(PixelValues(basis, raster.columns, raster.rows, places));
    }
    EXPECT_EQ(values[0], values[1]);
  }
}

/// What pieces() leave out is zero.
TEST_P(Pixels, PiecesReachTheirTilesOnly) {
  for (const MeshCase& c : knotreel::testing::law_cases(kPixelsSeed, 5)) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    const Raster raster{61, 53};
    const std::vector<Vec2> places = mixed_places(c.mesh, raster);
    const PixelValues pixels(basis, raster.columns, raster.rows, places);
    const std::size_t pieces = basis.pieces().pieces.size();
    std::vector<bool> reached(pixels.tile_count() * pieces);
    for (std::size_t t = 0; t < pixels.tile_count(); ++t) {
      for (const std::uint32_t p : pixels.pieces(t)) reached[t * pieces + p] = true;
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
      const std::size_t tile =
          i / 61 / PixelValues::kSide * pixels.tile_columns() + i % 61 / PixelValues::kSide;
      const Vec2 direction = inward_direction(places[i], c.mesh.width, c.mesh.height);
      for (std::size_t p = 0; p < pieces; ++p) {
        if (reached[tile * pieces + p]) continue;
        const Piece& piece = basis.pieces().pieces[p];
        for (std::uint32_t t = piece.term_begin; t < piece.term_end; ++t)
          ASSERT_EQ(tent_value(basis.pieces().terms[t].tent, places[i], direction), 0);
      }
    }
  }
}

TEST_P(Pixels, SurfaceIsTheSumOfValuesTimesControlPoints) {
  for (const MeshCase& c : knotreel::testing::law_cases(kPixelsSeed, 5)) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    const Raster raster{61, 53};
    const std::vector<Vec2> places = mixed_places(c.mesh, raster);
    const PixelValues pixels(basis, raster.columns, raster.rows, places);
    const std::size_t n = space->function_count();
    const std::vector<double> values = dense(pixels);
    std::mt19937_64 random(kPixelsSeed);
    for (std::size_t channels = 1; channels <= 4; ++channels) {
      std::vector<double> control(n * channels);
      for (double& v : control) v = static_cast<double>(random() % 256);
      std::vector<double> out(raster.size() * channels);
      surface_at_pixels<double>(pixels, {control, static_cast<int>(channels)}, out);
      for (std::size_t i = 0; i < out.size(); ++i) {
        double sum = 0;
        for (std::size_t f = 0; f < n; ++f)
          sum += values[i / channels * n + f] * control[f * channels + i % channels];
        ASSERT_NEAR(out[i], sum, 1e-9);
      }
    }
  }
}

TEST(PixelsOfOtherSizes, AreRefused) {
  const Basis basis(
      std::make_shared<const SplineSpace>(knotreel::testing::MeshBuilder(8, 8).triangulated(), 2));
  const std::vector<Vec2> places(63);
  const std::vector<std::uint8_t> wanted(1);
  EXPECT_THROW(PixelValues(basis, 0, 8, {}), Error);
  EXPECT_THROW(PixelValues(basis, 8, 8, places), Error);
  EXPECT_THROW(PixelValues(basis, 8, 8, {}, wanted), Error);
}

/// Two pixels that trade places across a feature must each get the functions of its side.
TEST_P(Pixels, EachPlaceIsOnItsOwnSideOfAFeature) {
  knotreel::testing::MeshBuilder b(30, 20);
  b.segment(b.vertex(0, 10.2), b.vertex(30, 9.7), 2);
  const auto space = std::make_shared<const SplineSpace>(b.triangulated(), GetParam());
  const Basis basis(space);
  const Raster raster{30, 20};
  std::vector<Vec2> places = centres(space->mesh(), raster);
  const std::size_t above = 8 * 30 + 14;
  const std::size_t below = 11 * 30 + 14;
  const std::size_t n = space->function_count();
  const std::vector<double> before = dense(PixelValues(basis, 30, 20, {}));
  std::swap(places[above], places[below]);
  const std::vector<double> after = dense(PixelValues(basis, 30, 20, places));
  double jump = 0;
  for (std::size_t f = 0; f < n; ++f) {
    EXPECT_NEAR(after[above * n + f], before[below * n + f], 1e-12);
    EXPECT_NEAR(after[below * n + f], before[above * n + f], 1e-12);
    jump += std::abs(before[above * n + f] - before[below * n + f]);
  }
  EXPECT_NEAR(jump, 2, 1e-9) << "no function reaches across";
}

}  // namespace
}  // namespace knotreel::spline
