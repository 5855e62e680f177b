// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/joints.h"

#include <gtest/gtest.h>

#include <random>

#include "fit/fit_cases.h"
#include "support/bent_feature.h"

namespace knotreel::fit {
namespace {

using namespace knotreel::testing;

constexpr BentFeature kFeature{{10, 26}, {29, 20}, {54, 25}};

/// Points of an arc over the feature, that are not exact.
std::vector<CurvePoint> arc(bool joint, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, 0.1);
  std::vector<CurvePoint> points;
  const auto add = [&](Vec2 from, Vec2 to, int count) {
    for (int i = 0; i < count; ++i) {
      const Vec2 u = from + (double(i) / count) * (to - from);
      const double x = (u.x - 32) / 22;
      points.push_back({u, {u.x + noise(random), 20 + 6 * x * x + noise(random)}});
    }
  };
  add(kFeature.left, kFeature.middle, 20);
  add(kFeature.middle, kFeature.right, 25);
  points[20].joint = joint;
  return points;
}

double bend(const spline::Basis& basis, std::span<const Vec2> displacement) {
  return kFeature.bend([&](Vec2 u) { return image_points(basis, displacement, {u}).front(); });
}

class Joints : public ::testing::TestWithParam<int> {};

TEST_P(Joints, AreWhereCurvesGoOnWithoutABend) {
  const spline::Basis basis(make_space(kFeature.mesh(), GetParam()));
  const std::vector<Vec2> places = scattered_places(64, 48, 0.2, 3);
  const spline::PixelValues values(basis, 64, 48, places);
  const auto mean_bend = [&](bool joint, double weight) {
    double sum = 0;
    for (unsigned seed = 1; seed <= 8; ++seed) {
      sum += bend(basis, fit_geometry(values, places, arc(joint, seed),
                                      {.joint_weight = weight, .ridge = 0, .least = 0}));
    }
    return sum / 8;
  };
  const double without = mean_bend(false, 1e6);
  EXPECT_GT(without, 0.02);
  EXPECT_EQ(mean_bend(true, 0), without);
  EXPECT_LT(mean_bend(true, 2), 0.6 * without);
  EXPECT_LT(mean_bend(true, 1e6), 1e-3);
}

TEST_P(Joints, HoldWhereACurveIsSmooth) {
  // Of segments in one line the identity is smooth: nothing is asked of it.
  MeshBuilder b(64, 48);
  const auto middle = b.vertex(29, 24);
  b.segment(b.vertex(10, 24), middle, 1);
  b.segment(middle, b.vertex(54, 24), 2);
  const auto space = make_space(b.triangulated(), GetParam());
  const std::vector<JointEquation> equations = joint_equations(*space, std::vector{Vec2{29.3, 24.2}});
  ASSERT_EQ(equations.size(), 1u);
  EXPECT_LT(norm(equations[0].wanted), 1e-12);
  EXPECT_NEAR(equations[0].terms[0].factor + equations[0].terms[1].factor + equations[0].terms[2].factor, 0,
              1e-12);
  EXPECT_LT(norm(space->geometry_greville()[equations[0].terms[0].group] - Vec2{29, 24}), 1e-12);
}

TEST_P(Joints, AreNowhereElse) {
  const auto space = make_space(kFeature.mesh(), GetParam());
  for (const Vec2 p : {kFeature.middle + Vec2{0.4, -0.4}, kFeature.left, kFeature.right, Vec2{40, 40}}) {
    EXPECT_TRUE(joint_equations(*space, std::vector{p}).empty()) << p.x << " " << p.y;
  }
}

INSTANTIATE_TEST_SUITE_P(Degrees, Joints, ::testing::Values(2, 3));

TEST(Joint, IsNoneForDegreeOne) {
  EXPECT_TRUE(joint_equations(*make_space(kFeature.mesh(), 1), std::vector{kFeature.middle}).empty());
}

TEST(Joint, IsNoneWhereThreeSegmentsMeet) {
  MeshBuilder b(64, 48);
  const auto middle = b.vertex(29, 24);
  for (const Vec2 p : {Vec2{10, 24}, Vec2{54, 24}, Vec2{30, 40}}) b.segment(b.vertex(p.x, p.y), middle, 1);
  EXPECT_TRUE(joint_equations(*make_space(b.triangulated(), 2), std::vector{Vec2{29, 24}}).empty());
}

}  // namespace
}  // namespace knotreel::fit
