// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "knotreel/base/error.h"
#include "knotreel/motion/flow.h"
#include "motion/scenes.h"

namespace knotreel::motion {
namespace {

using testing::constant_flow;
using Mask = std::vector<std::uint8_t>;

constexpr int kSize = 100;

Vec2 motion_at(Vec2 p, const Flow& flow, const Mask& mask) {
  return point_motion(std::vector{p}, flow, mask).front();
}

/// dx grows with x; every pixel says where it is.
Flow ramp() {
  Flow flow{kSize, kSize, {}};
  for (int i = 0; i < kSize * kSize; ++i) {
    flow.xy.push_back(float(i % kSize) + 0.5F);
    flow.xy.push_back(-1);
  }
  return flow;
}

TEST(PointMotion, IsTheFlowWhereItIsConsistent) {
  const Mask all(kSize * kSize, 1);
  for (const Vec2 p : {Vec2{50, 50}, Vec2{20.3, 80.9}, Vec2{0.5, 0.5}}) {
    EXPECT_NEAR(motion_at(p, ramp(), all).x, p.x, 1e-5);
    EXPECT_EQ(motion_at(p, ramp(), all).y, -1);
  }
}

TEST(PointMotion, PointsOnTheBorderMoveLikeThePixelsThere) {
  const Mask all(kSize * kSize, 1);
  EXPECT_EQ(motion_at({0, 0}, ramp(), all), (Vec2{0.5, -1}));
  EXPECT_EQ(motion_at({kSize, kSize}, ramp(), all), (Vec2{kSize - 0.5, -1}));
}

TEST(PointMotion, NeighboursThatAreNotConsistentDoNotCount) {
  Flow flow = constant_flow(kSize, kSize, {2, 3});
  Mask mask(kSize * kSize, 1);
  flow.xy[2 * (50 * kSize + 51)] = 1000;
  mask[50 * kSize + 51] = 0;
  EXPECT_NEAR(motion_at({50.9, 50.5}, flow, mask).x, 2, 1e-6);
}

TEST(PointMotion, ElsewhereIsTheMedianAround) {
  Flow flow = constant_flow(kSize, kSize, {2, 3});
  Mask mask(kSize * kSize, 1);
  for (int y = 40; y < 60; ++y) {
    for (int x = 40; x < 60; ++x) {
      flow.xy[std::size_t(2 * (y * kSize + x))] = 1000;
      mask[std::size_t(y * kSize + x)] = 0;
    }
  }
  for (int y = 38; y < 62; ++y) flow.xy[std::size_t(2 * (y * kSize + 39))] = -70;  // outliers
  EXPECT_EQ(motion_at({50, 50}, flow, mask), (Vec2{2, 3}));
}

TEST(PointMotion, IsZeroWhereNothingIsKnown) {
  const Flow flow = constant_flow(kSize, kSize, {2, 3});
  Mask mask(kSize * kSize, 0);
  EXPECT_EQ(motion_at({50, 50}, flow, mask), (Vec2{}));
  mask[50 * kSize + 50 + kMotionReach] = 1;
  EXPECT_EQ(motion_at({50.5, 50.5}, flow, mask), (Vec2{2, 3}));
  EXPECT_EQ(motion_at({49.5, 50.5}, flow, mask), (Vec2{}));
}

TEST(PointMotion, RefusesAMaskOfAnotherSize) {
  EXPECT_THROW(motion_at({}, constant_flow(4, 4, {}), Mask(15)), Error);
  EXPECT_THROW(motion_at({}, Flow{}, Mask{}), Error);
}

}  // namespace
}  // namespace knotreel::motion
