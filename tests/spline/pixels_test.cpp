#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "knotreel/base/parallel.h"
#include "knotreel/spline/basis.h"
#include "spline/law_cases.h"

/// Basis functions at pixels with places of their own, against evaluation point by point.
namespace knotreel::spline {
namespace {

using knotreel::testing::MeshCase;

constexpr std::uint64_t kSeed = 20260404;

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
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(-2, 2);
  std::vector<Vec2> places = centres(mesh, raster);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].x < mesh.width / 3 || random() % 3 == 0) continue;
    places[i] = {std::clamp(places[i].x + unit(random), 0.0, mesh.width),
                 std::clamp(places[i].y + unit(random), 0.0, mesh.height)};
  }
  for (const Vec2 p : knotreel::testing::probe_points(mesh, kSeed, 0)) {
    if (p.x < mesh.width / 3) continue;
    const int x = std::min(raster.columns - 1, static_cast<int>(p.x * raster.columns / mesh.width));
    const int y = std::min(raster.rows - 1, static_cast<int>(p.y * raster.rows / mesh.height));
    places[std::size_t(y) * std::size_t(raster.columns) + std::size_t(x)] = p;
  }
  return places;
}

std::vector<double> dense(const GridValues& grid, const Raster& raster, std::size_t functions) {
  std::vector<double> out(raster.size() * functions);
  for (FunctionIndex f = 0; f < functions; ++f) {
    for (const GridValues::Row& r : grid.rows_of(f)) {
      for (int x = r.x_begin; x < r.x_end; ++x) {
        out[(std::size_t(r.y) * std::size_t(raster.columns) + std::size_t(x)) * functions + f] =
            grid.values[r.offset + std::size_t(x - r.x_begin)];
      }
    }
  }
  return out;
}

void expect_same_rows(const GridValues& a, const GridValues& b, FunctionIndex f, int begin, int end) {
  std::vector<GridValues::Row> expected;
  for (const GridValues::Row& r : a.rows_of(f)) {
    if (r.y >= begin && r.y < end) expected.push_back(r);
  }
  ASSERT_EQ(b.rows_of(f).size(), expected.size());
  for (std::size_t i = 0; i < GridValues::kMargin; ++i) {
    ASSERT_EQ(b.values[i], 0);
    ASSERT_EQ(b.values[b.values.size() - 1 - i], 0);
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const GridValues::Row& p = expected[i];
    const GridValues::Row& q = b.rows_of(f)[i];
    ASSERT_EQ(p.y, q.y);
    ASSERT_EQ(p.x_begin, q.x_begin);
    ASSERT_EQ(p.x_end, q.x_end);
    const auto n = std::size_t(p.x_end - p.x_begin);
    for (std::size_t j = 0; j < n; ++j) ASSERT_EQ(a.values[p.offset + j], b.values[q.offset + j]);
  }
}

class Pixels : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, Pixels, ::testing::Values(1, 2, 3));

TEST_P(Pixels, ValuesAreThoseAtTheirPlaces) {
  for (const MeshCase& c : knotreel::testing::law_cases(kSeed, 40)) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    // Pixels need not be square.
    const Raster raster{static_cast<int>(c.mesh.width), static_cast<int>(c.mesh.height) / 2};
    const std::vector<Vec2> places = mixed_places(c.mesh, raster);
    const std::size_t n = space->function_count();
    std::vector<double> difference =
        dense(basis.evaluate_pixels(raster.columns, raster.rows, places, 0, raster.rows), raster, n);
    std::vector<BasisValue> values;
    double worst = 0;
    Vec2 worst_at;
    for (std::size_t i = 0; i < places.size(); ++i) {
      basis.evaluate(places[i], values);
      for (const BasisValue& v : values) difference[i * n + v.function] -= v.value;
      for (std::size_t f = 0; f < n; ++f) {
        if (std::abs(difference[i * n + f]) <= worst) continue;
        worst = std::abs(difference[i * n + f]);
        worst_at = places[i];
      }
    }
    EXPECT_LE(worst, 1e-12) << "at " << worst_at.x << ' ' << worst_at.y << '\n' << c.to_text();
  }
}

TEST_P(Pixels, PlacesAtTheCentresGiveTheGrid) {
  for (const MeshCase& c : knotreel::testing::law_cases(kSeed, 5)) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    const Raster raster{static_cast<int>(c.mesh.width), static_cast<int>(c.mesh.height)};
    const GridValues grid = basis.evaluate_grid(raster.columns, raster.rows);
    const GridValues pixels =
        basis.evaluate_pixels(raster.columns, raster.rows, centres(c.mesh, raster), 0, raster.rows);
    for (FunctionIndex f = 0; f < space->function_count(); ++f) {
      expect_same_rows(grid, pixels, f, 0, raster.rows);
    }
  }
}

TEST_P(Pixels, FunctionsThatAreNotWantedHaveNoRows) {
  for (const MeshCase& c : knotreel::testing::law_cases(kSeed, 5)) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    const Raster raster{61, 53};
    const std::vector<Vec2> places = mixed_places(c.mesh, raster);
    std::vector<std::uint8_t> wanted(space->function_count());
    for (std::size_t f = 0; f < wanted.size(); ++f) wanted[f] = f % 3 == 0;
    const GridValues all = basis.evaluate_pixels(raster.columns, raster.rows, places, 0, raster.rows);
    const GridValues some =
        basis.evaluate_pixels(raster.columns, raster.rows, places, 0, raster.rows, wanted);
    for (FunctionIndex f = 0; f < space->function_count(); ++f) {
      if (wanted[f]) {
        expect_same_rows(all, some, f, 0, raster.rows);
      } else {
        EXPECT_TRUE(some.rows_of(f).empty()) << "function " << f;
      }
    }
  }
}

TEST_P(Pixels, BandsAndThreadsDoNotMatter) {
  for (const MeshCase& c : knotreel::testing::law_cases(kSeed, 5)) {
    SCOPED_TRACE(c.name);
    const auto space = std::make_shared<const SplineSpace>(c.mesh, GetParam());
    const Basis basis(space);
    const Raster raster{61, 53};
    const std::vector<Vec2> places = mixed_places(c.mesh, raster);
    GridValues whole;
    {
      const ThreadCap cap(1);
      whole = basis.evaluate_pixels(raster.columns, raster.rows, places, 0, raster.rows);
    }
    const ThreadCap cap(2);
    for (const auto& [begin, end] : {std::pair{0, 53}, {0, 1}, {1, 19}, {19, 52}, {52, 53}, {53, 53}}) {
      const GridValues part = basis.evaluate_pixels(raster.columns, raster.rows, places, begin, end);
      for (FunctionIndex f = 0; f < space->function_count(); ++f) {
        expect_same_rows(whole, part, f, begin, end);
      }
    }
  }
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
  const std::vector<double> before = dense(basis.evaluate_grid(30, 20), raster, n);
  std::swap(places[above], places[below]);
  const std::vector<double> after = dense(basis.evaluate_pixels(30, 20, places, 0, 20), raster, n);
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
