// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/fit_curve.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "support/rounds.h"

namespace knotreel::exporting {
namespace {

Vec2 at(const Curve& c, double t) {
  const double s = 1 - t;
  return (s * s * s) * c[0] + (3 * s * s * t) * c[1] + (3 * s * t * t) * c[2] + (t * t * t) * c[3];
}

std::vector<Vec2> sampled(const std::vector<Curve>& chain) {
  std::vector<Vec2> points;
  for (const Curve& c : chain) {
    for (int i = 0; i <= 32; ++i) points.push_back(at(c, i / 32.0));
  }
  return points;
}

/// Largest distance of samples of the one from the other, both ways.
double distance(const std::vector<Curve>& a, const std::vector<Curve>& b) {
  const auto one_way = [](const std::vector<Vec2>& from, const std::vector<Vec2>& to) {
    double worst = 0;
    for (const Vec2 p : from) {
      double nearest = INFINITY;
      for (std::size_t i = 0; i + 1 < to.size(); ++i) {
        nearest = std::min(nearest, distance_to_segment(p, to[i], to[i + 1]));
      }
      worst = std::max(worst, nearest);
    }
    return worst;
  };
  return std::max(one_way(sampled(a), sampled(b)), one_way(sampled(b), sampled(a)));
}

/// A part of a circle as `count` quadratics.
std::vector<Curve> arc(double radius, double from, double to, int count) {
  std::vector<Curve> chain;
  for (int i = 0; i < count; ++i) {
    const double a = from + (to - from) * i / count;
    const double b = from + (to - from) * (i + 1) / count;
    const Vec2 p = radius * Vec2{std::cos(a), std::sin(a)};
    const Vec2 q = radius * Vec2{std::cos(b), std::sin(b)};
    const double m = 0.5 * (a + b);
    const Vec2 middle = radius / std::cos(0.5 * (b - a)) * Vec2{std::cos(m), std::sin(m)};
    chain.push_back({p, (1.0 / 3) * (p + 2 * middle), (1.0 / 3) * (q + 2 * middle), q});
  }
  return chain;
}

void expect_connected(const std::vector<Curve>& chain, const std::vector<Curve>& source) {
  ASSERT_FALSE(chain.empty());
  EXPECT_EQ(chain.front()[0], source.front()[0]);
  EXPECT_EQ(chain.back()[3], source.back()[3]);
  for (std::size_t i = 0; i + 1 < chain.size(); ++i) EXPECT_EQ(chain[i][3], chain[i + 1][0]);
}

TEST(Simplified, CircleTakesFewCurvesAndKeepsItsPlace) {
  for (const double radius : {2.0, 20.0, 200.0}) {
    const auto source = arc(radius, 0, 1.9 * std::numbers::pi, 40);
    for (const double tolerance : {0.02, 0.1}) {
      const auto chain = simplified(source, tolerance);
      expect_connected(chain, source);
      EXPECT_LE(chain.size(), 16u);
      EXPECT_LE(distance(chain, source), 1.5 * tolerance) << radius << ' ' << tolerance;
    }
  }
}

/// Few samples leave arms free to grow: what is between the samples has to stay near as well.
TEST(Simplified, NoSpikesBetweenSamples) {
  std::mt19937 random(7);
  std::normal_distribution<double> step(0, 1);
  for (int round = 0; round < testing::rounds(400); ++round) {
    std::vector<Curve> source;
    Vec2 x{50, 50};
    double angle = step(random);
    const double size = std::exp(1.5 * step(random));
    const double bend = 0.5 * std::abs(step(random));
    for (int i = 0; i < 1 + round % 12; ++i) {
      const double turn = bend * step(random);
      const double length = size * std::exp(step(random));
      const auto towards = [](double a) { return Vec2{std::cos(a), std::sin(a)}; };
      const Vec2 end = x + length * towards(angle + 0.5 * turn);
      source.push_back(
          {x, x + 0.4 * length * towards(angle), end - 0.4 * length * towards(angle + turn), end});
      x = end;
      angle += turn;
    }
    for (const double tolerance : {0.02, 0.5}) {
      const auto chain = simplified(source, tolerance);
      expect_connected(chain, source);
      EXPECT_LE(chain.size(), source.size());
      EXPECT_LE(distance(chain, source), 2 * tolerance) << round;
    }
  }
}

TEST(Simplified, ClosedCurvesStayClosed) {
  auto source = arc(30, 0, 2 * std::numbers::pi, 32);
  source.back()[3] = source.front()[0];
  const auto chain = simplified(source, 0.05);
  expect_connected(chain, source);
  EXPECT_LE(chain.size(), 10u);
  EXPECT_LE(distance(chain, source), 0.075);
}

TEST(Simplified, LinesOnALineBecomeOneAndCornersStay) {
  std::vector<Curve> source;
  for (int i = 0; i < 10; ++i) source.push_back(straight({double(i), 0}, {double(i + 1), 0}));
  for (int i = 0; i < 10; ++i) source.push_back(straight({10, double(i)}, {10, double(i + 1)}));
  const auto chain = simplified(source, 0.05);
  ASSERT_EQ(chain.size(), 2u);
  EXPECT_EQ(chain[0], straight({0, 0}, {10, 0}));
  EXPECT_EQ(chain[1], straight({10, 0}, {10, 10}));
}

TEST(Simplified, CurvesThatMeetAtAnAngleKeepTheirCorner) {
  auto source = arc(20, 0, 1, 6);
  const Vec2 corner = source.back()[3];
  // Back along a circle about another centre.
  for (const Curve& c : arc(20, 2, 3, 6)) {
    const Vec2 shift = corner - arc(20, 2, 3, 6).front()[0];
    source.push_back({c[0] + shift, c[1] + shift, c[2] + shift, c[3] + shift});
  }
  const auto chain = simplified(source, 0.1);
  expect_connected(chain, source);
  double nearest = INFINITY;
  for (const Curve& c : chain) nearest = std::min(nearest, norm(c[3] - corner));
  EXPECT_LT(nearest, 1e-9);
}

TEST(Simplified, StraightCurvesBecomeLines) {
  std::vector<Curve> source;
  for (int i = 0; i < 5; ++i) {
    const Vec2 a{2.0 * i, 1.0 * i};
    const Vec2 b{2.0 * i + 2, 1.0 * i + 1};
    source.push_back({a, a + 0.2 * (b - a), a + 0.7 * (b - a), b});
  }
  const auto chain = simplified(source, 0.01);
  ASSERT_EQ(chain.size(), 1u);
  EXPECT_TRUE(is_straight(chain[0]));
}

}  // namespace
}  // namespace knotreel::exporting
