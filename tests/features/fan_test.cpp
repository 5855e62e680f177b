// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/fan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "features/drawings.h"

namespace knotreel::features {
namespace {

using testing::draw;

Vec2 ray(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

Fan fan(Vec2 tip, const std::vector<double>& angles) {
  Fan result{tip, {}};
  for (const double a : angles) result.rays.push_back(ray(a));
  return result;
}

/// The area that a point is in, by angles.
std::size_t area_of(const Fan& fan, Vec2 p) {
  const auto angle_from = [&](Vec2 first, Vec2 v) {
    const double a = std::atan2(cross(first, v), dot(first, v));
    return a < 0 ? a + 2 * std::numbers::pi : a;
  };
  std::size_t area = 0;
  double nearest = 7;
  for (std::size_t i = 0; i < fan.rays.size(); ++i) {
    const double a = angle_from(fan.rays[i], p - fan.tip);
    if (a < nearest) area = i, nearest = a;
  }
  return area;
}

std::vector<Vec2> points_on(const Fan& fan) {
  std::vector<Vec2> points;
  for (const Vec2& r : fan.rays) points.push_back(fan.tip + 6 * r);
  return points;
}

image::Image drawn(const Fan& fan, const std::vector<double>& colours) {
  return draw(20, 20, [&](double x, double y) { return colours[area_of(fan, {x, y})]; });
}

TEST(Fan, SharesAreWhatManySamplesCount) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-0.7, 1.7);
  std::uniform_real_distribution<double> angle(0.3, 2.0);
  constexpr int kSamples = 200;
  for (int round = 0; round < 60; ++round) {
    std::vector<double> angles{angle(random)};
    const int rays = 2 + round % 3;
    // The rest of the turn goes to the last area, which is of more than half a turn at times.
    for (int i = 1; i < rays; ++i) angles.push_back(angles.back() + 0.9 * angle(random));
    const Fan f = fan({3 + place(random), 5 + place(random)}, angles);
    std::vector<double> counted(std::size_t(rays), 0.0);
    for (int j = 0; j < kSamples; ++j) {
      for (int i = 0; i < kSamples; ++i)
        counted[area_of(f, {3 + (i + 0.5) / kSamples, 5 + (j + 0.5) / kSamples})] +=
            1.0 / (kSamples * kSamples);
    }
    std::vector<double> shares(std::size_t(rays), -1.0);
    shares_of(f, 3, 5, shares.data());
    double sum = 0;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      EXPECT_NEAR(shares[i], counted[i], 0.01) << "round " << round << ", area " << i;
      sum += shares[i];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
}

TEST(Fan, IsFoundFromNearBy) {
  const std::vector<std::vector<double>> shapes{{0.3, 1.9},    {-2.8, -2.1},      {1, 1.6},
                                                {0.2, 2, 4.1}, {-0.5, 0.6, 2.64}, {0, 1.4, 3.1, 4.8}};
  for (const std::vector<double>& angles : shapes) {
    const Fan truth = fan({10.3, 9.6}, angles);
    const image::Image picture = drawn(truth, {200, 20, 120, 60});
    std::vector<double> off = angles;
    for (std::size_t i = 0; i < off.size(); ++i) off[i] += i % 2 == 0 ? 0.08 : -0.05;
    const auto found = fit_fan(picture, fan({10.6, 9.3}, off), points_on(truth));
    ASSERT_TRUE(found);
    // The tip of an acute one lies somewhere along it.
    const double sine = std::sin(std::min(std::numbers::pi / 2, angles[1] - angles[0]));
    EXPECT_LT(norm(found->fan.tip - truth.tip), 0.04 / sine) << angles.size() << " from " << angles[0];
    EXPECT_LT(found->error, 0.01);
    for (std::size_t i = 0; i < angles.size(); ++i)
      EXPECT_NEAR(std::abs(cross(found->fan.rays[i], ray(angles[i]))), 0, 0.03);
  }
}

TEST(Fan, WhatIsNoFanIsTold) {
  const auto error = [](const image::Image& picture) {
    const Fan start = fan({10, 10}, {0.4, 2});
    const auto found = fit_fan(picture, start, points_on(start));
    return found ? found->error : std::numeric_limits<double>::infinity();
  };
  EXPECT_LT(error(drawn(fan({10, 10}, {0.4, 2}), {220, 30})), 0.01);
  EXPECT_GT(error(drawn(fan({10, 10}, {0.4, 2, 4}), {220, 30, 120})), 0.1) << "three areas";
  EXPECT_GT(error(testing::disc(20, 9, 9.5, 1.5)), 0.1) << "a dot";
  EXPECT_GT(error(draw(20, 20, [](double, double) { return 90.0; })), 1) << "nothing at all";
}

TEST(Fan, NothingNextToTheSides) {
  const image::Image picture = drawn(fan({10, 10}, {0.4, 2}), {220, 30});
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Vec2 tip :
       {Vec2{2.9, 10}, {10, 2.9}, {16.1, 10}, {10, 17}, {-1e300, 10}, {10, 1e300}, {kNan, 10}})
    EXPECT_FALSE(fit_fan(picture, fan(tip, {0.4, 2}), {{9, 9}, {11, 9}}));
}

TEST(Fan, WhatAlphaHidesDoesNotCount) {
  const Fan truth = fan({10.3, 9.6}, {0.3, 1.9});
  const image::Image alpha = drawn(truth, {255, 0});
  image::Image picture = image::make_image(20, 20, 4);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) {
      // Hidden colours are noise.
      for (int c = 0; c < 3; ++c)
        picture.at(x, y, c) = alpha.at(x, y, 0) > 0 ? 100.0F : float((37 * x + 91 * y + 50 * c) % 256);
      picture.at(x, y, 3) = alpha.at(x, y, 0);
    }
  }
  const auto found = fit_fan(picture, fan({10.6, 9.3}, {0.35, 1.85}), points_on(truth));
  ASSERT_TRUE(found);
  EXPECT_LT(norm(found->fan.tip - truth.tip), 0.03);
  EXPECT_LT(found->error, 0.01);
}

}  // namespace
}  // namespace knotreel::features
