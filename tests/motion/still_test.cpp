// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/still.h"

#include <gtest/gtest.h>

#include "knotreel/base/error.h"
#include "knotreel/motion/flow.h"
#include "knotreel/motion/warp.h"
#include "motion/scenes.h"

namespace knotreel::motion {
namespace {

using testing::constant_flow;
using testing::draw;
using testing::moved_texture;
using testing::Texture;
using testing::with_noise;

constexpr int kStillWidth = 160;
constexpr int kStillHeight = 120;

std::vector<Vec2> grid() {
  std::vector<Vec2> points;
  for (int y = 4; y < kStillHeight; y += 6) {
    for (int x = 4; x < kStillWidth; x += 6) points.push_back({double(x), double(y)});
  }
  return points;
}

std::vector<Stillness> still_grid(const image::Image& from, const image::Image& to) {
  const Luma a = luma_of(from);
  const Luma b = luma_of(to);
  const FlowPair pair = find_flow_pair(a, b);
  const std::vector<Vec2> points = grid();
  return still_points(points, point_motion(points, pair.forward, pair.consistent), a, b,
                      warp(b, pair.forward));
}

bool is_still(Stillness s) {
  return s != Stillness::kMoves;
}

double share(const std::vector<Stillness>& stillness) {
  return double(std::count_if(stillness.begin(), stillness.end(), is_still)) / double(stillness.size());
}

class StaticNoise : public ::testing::TestWithParam<double> {};

TEST_P(StaticNoise, DoesNotMove) {
  const image::Image scene = moved_texture(kStillWidth, kStillHeight, {});
  const double sigma = GetParam();
  EXPECT_GT(share(still_grid(with_noise(scene, sigma, 1), with_noise(scene, sigma, 2))), 0.99);
}

INSTANTIATE_TEST_SUITE_P(Some, StaticNoise, ::testing::Values(0.0, 2.0, 5.0, 10.0));

TEST(StillPoints, NoiseOnNothingDoesNotMove) {
  const image::Image flat = draw(kStillWidth, kStillHeight, [](Vec2) { return 128.0; });
  EXPECT_GT(share(still_grid(with_noise(flat, 5, 1), with_noise(flat, 5, 2))), 0.99);
  EXPECT_GT(share(still_grid(with_noise(flat, 8, 1), with_noise(flat, 8, 2))), 0.9);
}

TEST(StillPoints, AMovingCameraMovesEverything) {
  const image::Image from = with_noise(moved_texture(kStillWidth, kStillHeight, {}), 3, 1);
  const image::Image to = with_noise(moved_texture(kStillWidth, kStillHeight, {2, 1}), 3, 2);
  EXPECT_LT(share(still_grid(from, to)), 0.05);
}

TEST(StillPoints, OnlyAMovedPatchMoves) {
  const Texture background(1);
  const Texture patch(2);
  const auto scene = [&](Vec2 d, unsigned seed) {
    const auto value = [&](Vec2 p) {
      const Vec2 q = p - d;
      return q.x > 50 && q.x < 110 && q.y > 40 && q.y < 90 ? patch(q) : background(p);
    };
    return with_noise(draw(kStillWidth, kStillHeight, value), 2, seed);
  };
  const auto still = still_grid(scene({}, 1), scene({3, 1}, 2));
  const std::vector<Vec2> points = grid();
  int inside = 0;
  int moving_inside = 0;
  int outside = 0;
  int still_outside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto [x, y] = points[i];
    if (x > 60 && x < 100 && y > 50 && y < 80) {
      ++inside;
      moving_inside += is_still(still[i]) ? 0 : 1;
    } else if (x < 40 || x > 123 || y < 30 || y > 101) {
      ++outside;
      still_outside += is_still(still[i]) ? 1 : 0;
    }
  }
  EXPECT_GT(moving_inside, 0.95 * inside);
  EXPECT_GT(still_outside, 0.95 * outside);
}

/// Two flat pictures; in the second, the 3 x 3 pixels around (20, 20) are lighter by 30.
std::pair<Luma, Luma> changed_square() {
  const Luma flat{40, 40, std::vector<std::uint8_t>(1600, 100)};
  Luma changed = flat;
  for (std::size_t y = 19; y < 22; ++y) {
    for (std::size_t x = 19; x < 22; ++x) changed.v[y * 40 + x] = 130;
  }
  return {flat, changed};
}

TEST(StillTest, ComparesMeanResidualsOfTheWindow) {
  // A square of 3 x 3 pixels differs by 30, and the flow, being zero, leaves as much.
  const auto [from, to] = changed_square();
  EXPECT_EQ(StillTest(from, to, to).at({20.5, 20.5}), Stillness::kEither);
  // A flow that fetches other pixels explains the change, and windows that see it are not still.
  const StillTest moving(from, to, warp(to, constant_flow(40, 40, {12, 0})));
  EXPECT_EQ(moving.at({20.5, 20.5}), Stillness::kMoves);
  EXPECT_EQ(moving.at({24.5, 17.5}), Stillness::kMoves);
  EXPECT_EQ(moving.at({27.5, 20.5}), Stillness::kEither);
  EXPECT_EQ(moving.at({1000, -1000}), Stillness::kEither);
  // Where it fetches the square, it makes a change out of none.
  EXPECT_EQ(moving.at({8.5, 20.5}), Stillness::kStays);
}

TEST(StillTest, TheBorderCountsLikeTheRest) {
  // What changes by as much everywhere is missed by as much everywhere.
  const Luma from{9, 7, std::vector<std::uint8_t>(63, 100)};
  const Luma to{9, 7, std::vector<std::uint8_t>(63, 110)};
  const StillTest barely(from, to, from, {.radius = 0, .ratio = 1, .slack = 99.9});
  const StillTest hardly(from, to, from, {.radius = 0, .ratio = 1, .slack = 100.1});
  for (int y = 0; y < 7; ++y) {
    for (int x = 0; x < 9; ++x) {
      EXPECT_EQ(barely.at({x + 0.5, y + 0.5}), Stillness::kMoves) << x << ' ' << y;
      EXPECT_EQ(hardly.at({x + 0.5, y + 0.5}), Stillness::kEither) << x << ' ' << y;
    }
  }
}

TEST(StillPoints, WhatHasNoMotionIsStill) {
  const auto [from, to] = changed_square();
  const std::vector<Vec2> points{{20.5, 20.5}, {20.5, 20.5}};
  const std::vector<Vec2> motions{{12, 0}, {}};
  EXPECT_EQ(still_points(points, motions, from, to, warp(to, constant_flow(40, 40, {12, 0}))),
            (std::vector<Stillness>{Stillness::kMoves, Stillness::kStays}));
}

TEST(StillPoints, RefusesWhatDoesNotFit) {
  const Luma luma{4, 4, std::vector<std::uint8_t>(16)};
  const std::vector<Vec2> one(1);
  EXPECT_THROW(still_points(one, {}, luma, luma, luma), Error);
  EXPECT_THROW(StillTest(luma, luma, {5, 4, std::vector<std::uint8_t>(20)}), Error);
  EXPECT_THROW(StillTest(luma, luma, luma, {.radius = -1}), Error);
}

}  // namespace
}  // namespace knotreel::motion
