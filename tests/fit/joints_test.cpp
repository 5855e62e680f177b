#include "fit/joints.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "fit/fit_cases.h"
#include "support/mesh_cases.h"

namespace knotreel::fit {
namespace {

using namespace knotreel::testing;

constexpr Vec2 kLeft{10, 26}, kMiddle{29, 20}, kRight{54, 25};

/// A feature of two segments that meet at an angle.
mesh::KnotMesh bent_feature() {
  MeshBuilder b(64, 48);
  const auto middle = b.vertex(kMiddle.x, kMiddle.y);
  b.segment(b.vertex(kLeft.x, kLeft.y), middle, 1);
  b.segment(middle, b.vertex(kRight.x, kRight.y), 2);
  for (int i = 0; i < 6; ++i) {
    b.free(5.1 + 10.7 * i, 9.2 + 0.6 * (i % 2));
    b.free(4.7 + 10.9 * i, 38.4 + 0.7 * (i % 2));
  }
  return b.triangulated();
}

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
  add(kLeft, kMiddle, 20);
  add(kMiddle, kRight, 25);
  points[20].joint = joint;
  return points;
}

Vec2 drawn_at(const spline::Basis& basis, std::span<const Vec2> displacement, Vec2 u) {
  return image_points(basis, displacement, {u}).front();
}

/// Angle between the two curves where they meet, radians.
double bend(const spline::Basis& basis, std::span<const Vec2> displacement) {
  constexpr double kStep = 1e-5;
  const Vec2 at = drawn_at(basis, displacement, kMiddle);
  const Vec2 before = at - drawn_at(basis, displacement, kMiddle + kStep * (kLeft - kMiddle));
  const Vec2 behind = drawn_at(basis, displacement, kMiddle + kStep * (kRight - kMiddle)) - at;
  return std::abs(std::atan2(cross(before, behind), dot(before, behind)));
}

class Joints : public ::testing::TestWithParam<int> {};

TEST_P(Joints, AreWhereCurvesGoOnWithoutABend) {
  const spline::Basis basis(make_space(bent_feature(), GetParam()));
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
  EXPECT_NEAR(equations[0].factors[0] + equations[0].factors[1] + equations[0].factors[2], 0, 1e-12);
  EXPECT_LT(norm(space->geometry_greville()[equations[0].groups[0]] - Vec2{29, 24}), 1e-12);
}

TEST_P(Joints, AreNowhereElse) {
  const auto space = make_space(bent_feature(), GetParam());
  for (const Vec2 p : {kMiddle + Vec2{0.4, -0.4}, kLeft, kRight, Vec2{40, 40}}) {
    EXPECT_TRUE(joint_equations(*space, std::vector{p}).empty()) << p.x << " " << p.y;
  }
}

INSTANTIATE_TEST_SUITE_P(Degrees, Joints, ::testing::Values(2, 3));

TEST(Joint, IsNoneForDegreeOne) {
  EXPECT_TRUE(joint_equations(*make_space(bent_feature(), 1), std::vector{kMiddle}).empty());
}

TEST(Joint, IsNoneWhereThreeSegmentsMeet) {
  MeshBuilder b(64, 48);
  const auto middle = b.vertex(29, 24);
  for (const Vec2 p : {Vec2{10, 24}, Vec2{54, 24}, Vec2{30, 40}}) b.segment(b.vertex(p.x, p.y), middle, 1);
  EXPECT_TRUE(joint_equations(*make_space(b.triangulated(), 2), std::vector{Vec2{29, 24}}).empty());
}

}  // namespace
}  // namespace knotreel::fit
