// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/smooth_vertices.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>

namespace knotreel::vectorize {
namespace {

constexpr int kVertexEach = 12;  // points

/// A map of one curve, sampled at whole parameters, with a vertex at every twelfth point.
param::Parametrization map_of(int count, bool closed, const std::function<Vec2(double)>& curve) {
  param::Parametrization map;
  map.width = map.height = 400;
  map.polylines.push_back({});
  map.polylines[0].closed = closed;
  std::mt19937 random(11);
  std::normal_distribution<double> noise(0, 0.02);
  for (int i = 0; i < count; ++i) {
    param::CurveSample s;
    s.segment = std::uint32_t(i / kVertexEach);
    s.t = double(i % kVertexEach) / kVertexEach;
    s.position = curve(i) + Vec2{noise(random), noise(random)};
    s.pixel = int(s.position.y) * map.width + int(s.position.x);
    map.curve_samples.push_back(s);
  }
  return map;
}

Vec2 circle(double radius, double length) {
  return {200 + radius * std::cos(length / radius), 200 + radius * std::sin(length / radius)};
}

TEST(SmoothVertices, AreAllOfACircle) {
  for (const double radius : {12.0, 40.0, 150.0}) {
    const int points = int(2 * std::numbers::pi * radius);
    const auto map = map_of(points, true, [&](double i) { return circle(radius, i); });
    const auto smooth = smooth_vertices(map, {});
    for (int i = 0; i < points; ++i) EXPECT_EQ(smooth[i], i % kVertexEach == 0) << radius << ", " << i;
  }
}

TEST(SmoothVertices, AreNoCorners) {
  for (const double degrees : {15.0, 30.0, 90.0}) {
    const double turn = degrees * std::numbers::pi / 180;
    const auto map = map_of(49, false, [&](double i) {
      const double beyond = i - 24;
      return beyond < 0 ? Vec2{100 + beyond, 100}
                        : Vec2{100 + beyond * std::cos(turn), 100 + beyond * std::sin(turn)};
    });
    const auto smooth = smooth_vertices(map, {});
    EXPECT_TRUE(smooth[12]) << "on a straight side";
    EXPECT_FALSE(smooth[24]) << degrees;
    EXPECT_TRUE(smooth[36]) << "on the other";
    EXPECT_FALSE(smooth[0] || smooth[48]) << "at the ends";
  }
}

TEST(SmoothVertices, AreNotWhereACornerWasFound) {
  const auto map = map_of(250, true, [&](double i) { return circle(40, i); });
  features::FeatureChains chains;
  chains.width = chains.height = 400;
  features::ChainPoint corner;
  corner.x = map.curve_samples[36].pixel % 400;
  corner.y = map.curve_samples[36].pixel / 400;
  corner.corner = true;
  chains.chains.push_back({});
  chains.chains[0].points = {corner};
  const auto smooth = smooth_vertices(map, chains);
  EXPECT_TRUE(smooth[24]);
  EXPECT_FALSE(smooth[36]);
}

}  // namespace
}  // namespace knotreel::vectorize
