// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "fit/fit_cases.h"
#include "fit/folds.h"
#include "fit/geometry_map.h"
#include "knotreel/fit/geometry_fit.h"
#include "knotreel/spline/surface.h"
#include "support/models.h"

namespace knotreel::fit {
namespace {

using namespace knotreel::testing;

constexpr double kLeast = 0.05;
constexpr double kRounding = 1e-4;  // samples are taken in single precision

/// Displacements that may fold the map.
std::vector<Vec2> wild_displacement(const spline::SplineSpace& space, double reach, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(-reach, reach);
  std::vector<Vec2> displacement(space.geometry_count());
  for (Vec2& d : displacement) d = {unit(random), unit(random)};
  return displacement;
}

/// Areas that the map makes of a unit, one by one and in double precision, where samples are taken.
std::vector<double> areas(const spline::Basis& basis, std::span<const Vec2> displacement) {
  std::vector<double> result;
  const std::vector<double> control = displacement_control(basis.space(), displacement);
  const mesh::KnotMesh& mesh = basis.space().mesh();
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 from = mesh.knots[s.knots.front()].position;
    const Vec2 way = mesh.knots[s.knots.back()].position - from;
    const Vec2 normal = (1 / norm(way)) * Vec2{-way.y, way.x};
    const int count = std::max(2, static_cast<int>(std::ceil(norm(way) / 0.75)));
    for (int i = 0; i < count; ++i) {
      for (const double across : {-3.0, -1.5, -0.7, -1e-3, 1e-3, 0.7, 1.5, 3.0}) {
        const Vec2 u = from + ((i + 0.5) / count) * way + across * normal;
        if (u.x < 0 || u.y < 0 || u.x > mesh.width || u.y > mesh.height) continue;
        std::array<spline::Jet, 2> d;
        spline::surface_jets(basis, {control, 2}, u, across * normal, d);
        result.push_back((1 + d[0].dx) * (1 + d[1].dy) - d[0].dy * d[1].dx);
      }
    }
  }
  return result;
}

class Unfolding : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, Unfolding, ::testing::Values(1, 2, 3));

TEST_P(Unfolding, LeavesNoFoldAtTheSamples) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const auto model = blank_model(featured_mesh(seed), GetParam(), 1);
    const spline::Basis basis(model.space);
    std::vector<Vec2> displacement = wild_displacement(*model.space, 8, seed);
    const std::vector<double> before = areas(basis, displacement);
    ASSERT_LT(*std::min_element(before.begin(), before.end()), kLeast) << "seed " << seed;
    ASSERT_EQ(unfold_geometry(basis, displacement), 0u) << "seed " << seed;
    const std::vector<double> after = areas(basis, displacement);
    EXPECT_GT(*std::min_element(after.begin(), after.end()), kLeast - kRounding) << "seed " << seed;
  }
}

/// Only what moves a sample that folds shrinks, and only as often as it must.
TEST_P(Unfolding, ShrinksWhatFoldsByOneFactor) {
  const auto model = blank_model(featured_mesh(5), GetParam(), 1);
  const spline::Basis basis(model.space);
  const std::vector<Vec2> before = wild_displacement(*model.space, 8, 5);
  std::vector<Vec2> after = before;
  unfold_geometry(basis, after, 0.85);
  std::size_t same = 0;
  for (std::size_t g = 0; g < before.size(); ++g) {
    if (after[g] == before[g]) {
      ++same;
      continue;
    }
    const double rounds = std::log(norm(after[g]) / norm(before[g])) / std::log(0.85);
    EXPECT_NEAR(rounds, std::round(rounds), 1e-9) << "group " << g;
    EXPECT_NEAR(cross(after[g], before[g]), 0, 1e-9) << "group " << g;
  }
  EXPECT_LT(same, before.size());
  EXPECT_GT(same, 0u);
}

/// What shrinks again and again is summed once: it is as if all were summed anew.
TEST_P(Unfolding, FoldsOfShrunkDisplacementsAreThoseOfSmallerOnes) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    SCOPED_TRACE(seed);
    const auto model = blank_model(featured_mesh(seed), GetParam(), 1);
    const spline::Basis basis(model.space);
    Folds folds(basis, wild_displacement(*model.space, 8, seed));
    std::mt19937_64 random(seed);
    std::vector<std::uint8_t> shrinking(model.space->geometry_count());
    std::size_t found = 0;
    for (int round = 0; round < 9; ++round) {
      if (round % 3 == 0) {  // others than before
        for (std::uint8_t& s : shrinking) s = random() % 3 == 0 ? 1 : 0;
      }
      folds.shrink(shrinking, 0.8);
      Folds anew(basis, folds.displacement());
      found += folds.find(kLeast);
      anew.find(kLeast - kRounding);
      const std::vector<std::uint8_t> here = folds.groups();
      const std::vector<std::uint8_t> least = anew.groups();
      anew.shrink(shrinking, 1);
      anew.find(kLeast + kRounding);
      const std::vector<std::uint8_t> most = anew.groups();
      for (std::size_t g = 0; g < here.size(); ++g) {
        EXPECT_GE(here[g], least[g]) << "group " << g << ", round " << round;
        EXPECT_LE(here[g], most[g]) << "group " << g << ", round " << round;
      }
    }
    EXPECT_GT(found, 0U);
  }
}

TEST_P(Unfolding, LeavesAloneWhatDoesNotFold) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    auto model = blank_model(featured_mesh(seed), GetParam(), 1);
    displace_randomly(model, 1, seed);
    const spline::Basis basis(model.space);
    std::vector<Vec2> displacement = model.displacement;
    const std::vector<double> found = areas(basis, displacement);
    ASSERT_GT(*std::min_element(found.begin(), found.end()), kLeast) << "seed " << seed;
    EXPECT_EQ(unfold_geometry(basis, displacement), 0u) << "seed " << seed;
    EXPECT_EQ(displacement, model.displacement) << "seed " << seed;
  }
}

}  // namespace
}  // namespace knotreel::fit
