// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/edge_samples.h"

#include <gtest/gtest.h>

#include <cmath>

#include "track/upright_edge.h"

namespace knotreel::track {
namespace {

constexpr double kStrong = 60;  // levels over two steps

/// What is found from the middle of the picture along a normal to the right.
EdgeSample found_in(const image::Image& picture, double known, const EdgeSearch& search = {}) {
  EdgeSample sample;
  sample.position = {32, 32};
  sample.normal = {1, 0};
  find_edge(known, motion::luma_of(picture), search, sample);
  return sample;
}

TEST(EdgeSamples, LieAlongTheCurveAndGoWithItsEnds) {
  const UprightSegment segment(30);
  std::vector<Vec2> motion = segment.still;
  motion[segment.from] = {1, 0};
  motion[segment.to] = {3, 2};
  const auto samples = place_samples(*segment.basis, segment.displacement, segment.mesh(), motion);
  ASSERT_EQ(samples.size(), 21u);  // 1.5 pixels apart
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const EdgeSample& s = samples[i];
    const double t = static_cast<double>(i) / 20;
    EXPECT_NEAR(s.t, t, 1e-12);
    EXPECT_NEAR(norm(s.before - Vec2{32, 8 + 30 * t}), 0, 1e-9);
    EXPECT_NEAR(norm(s.position - s.before - Vec2{1 + 2 * t, 2 * t}), 0, 1e-9);
    EXPECT_NEAR(norm(s.normal), 1, 1e-12);
    EXPECT_NEAR(dot(s.normal, Vec2{2, 32}), 0, 1e-9);  // across where the curve is now
    EXPECT_EQ(s.segment, 0u);
  }
}

TEST(EdgeSamples, ShortCurvesHaveSomeToo) {
  const UprightSegment segment(2);
  EXPECT_EQ(place_samples(*segment.basis, segment.displacement, segment.mesh(), segment.still).size(), 4u);
}

TEST(EdgeSamples, FindAnEdgeWithinReach) {
  for (const double far : {-2.4, -1.3, -0.5, 0.0, 0.7, 1.0, 2.2}) {
    const EdgeSample sample = found_in(upright_edge(32 + far), kStrong);
    EXPECT_NEAR(sample.offset, far, 0.26) << far;
    EXPECT_GT(sample.weight, 50) << far;
    EXPECT_TRUE(sample.known);
  }
  EXPECT_EQ(found_in(upright_edge(37), kStrong).weight, 0);
  EXPECT_NEAR(found_in(upright_edge(37), kStrong, {.reach = 6}).offset, 5, 0.2);
}

TEST(EdgeSamples, TakeNoEdgeOfTheOtherDirectionOrMuchFainter) {
  for (const double known : {-kStrong, 4 * kStrong}) {
    const EdgeSample sample = found_in(upright_edge(33), known);
    EXPECT_EQ(sample.weight, 0) << known;
    EXPECT_EQ(sample.offset, 0) << known;
    EXPECT_TRUE(sample.known) << known;
  }
  EXPECT_NEAR(found_in(upright_edge(33, -40), -15).offset, 1, 0.1);
}

TEST(EdgeSamples, WithoutAnEdgeBeforeNoneIsLookedFor) {
  for (const double known : {0.0, kWeakestEdge - 0.1, 0.1 - kWeakestEdge}) {
    const EdgeSample sample = found_in(upright_edge(32), known);
    EXPECT_FALSE(sample.known) << known;
    EXPECT_EQ(sample.weight, 0) << known;
  }
}

TEST(EdgeSamples, PreferTheNearerOfTwoEdges) {
  for (const double side : {-1.0, 1.0}) {
    image::Image two = upright_edge(32 + 1.2 * side, 80);
    const image::Image farther = upright_edge(32 - 2.2 * side, 80);
    for (std::size_t i = 0; i < two.samples.size(); ++i) two.samples[i] += farther.samples[i] - 40;
    EXPECT_NEAR(found_in(two, 30).offset, 1.2 * side, 0.2) << side;
  }
}

/// Strong edges say more exactly where they are.
TEST(EdgeSamples, OffsetsWithinTheDeadZoneAreNone) {
  const EdgeSample faint = found_in(upright_edge(33, 30), 13, {.dead_zone = 1.5});
  EXPECT_GT(faint.weight, 0);
  EXPECT_EQ(faint.offset, 0);
  EXPECT_NEAR(found_in(upright_edge(33, 30), 13, {.dead_zone = 0.5}).offset, 1, 0.1);
  EXPECT_NEAR(found_in(upright_edge(33), kStrong, {.dead_zone = 1.5}).offset, 1, 0.1);
}

TEST(EdgeSamples, SlopesHaveTheDirectionOfTheNormal) {
  const motion::Luma luma = motion::luma_of(upright_edge(33.5));
  EXPECT_NEAR(steepest_at(luma, {33.5, 20}, {1, 0}), 57, 1);
  EXPECT_NEAR(steepest_at(luma, {33.5, 20}, {-1, 0}), -57, 1);
  EXPECT_NEAR(steepest_at(luma, {33.5, 20}, {0, 1}), 0, 1e-9);
  EXPECT_NEAR(steepest_at(luma, {28, 20}, {1, 0}), 0, 1);
  EXPECT_GT(steepest_near(luma, {31.5, 20}, {1, 0}, 2.5), 40);
  EXPECT_LT(steepest_near(luma, {31.5, 20}, {1, 0}, 2.5), steepest_near(luma, {33, 20}, {1, 0}, 2.5));
}

}  // namespace
}  // namespace knotreel::track
