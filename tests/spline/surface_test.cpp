// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knotreel/base/parallel.h"
#include "spline/law_cases.h"

/// Surfaces, whose functions are added up piece by piece, against the functions one by one.
namespace knotreel::spline {
namespace {

using knotreel::testing::MeshCase;

constexpr std::uint64_t kSurfaceSeed = 20260505;

class Surfaces : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, Surfaces, ::testing::Values(1, 2, 3));

std::vector<double> random_control(std::size_t size) {
  std::mt19937_64 random(kSurfaceSeed);
  std::vector<double> control(size);
  for (double& v : control) v = static_cast<double>(random() % 256);
  return control;
}

TEST_P(Surfaces, AtPointsAreSumsOfValuesTimesControlPoints) {
  for (const MeshCase& c : knotreel::testing::law_cases(kSurfaceSeed, 20)) {
    SCOPED_TRACE(c.name);
    const Basis basis(std::make_shared<const SplineSpace>(c.mesh, GetParam()));
    const std::vector<Vec2> points = knotreel::testing::probe_points(c.mesh, kSurfaceSeed, 500);
    for (std::size_t channels = 1; channels <= kMaxSurfaceChannels; ++channels) {
      const std::vector<double> control = random_control(basis.space().function_count() * channels);
      std::vector<double> out(points.size() * channels);
      surface_at_points(basis, {control, static_cast<int>(channels)}, points, out);
      std::vector<BasisValue> values;
      for (std::size_t i = 0; i < points.size(); ++i) {
        basis.evaluate(points[i], values);
        for (std::size_t k = 0; k < channels; ++k) {
          double sum = 0;
          for (const BasisValue& v : values) sum += v.value * control[v.function * channels + k];
          ASSERT_NEAR(out[i * channels + k], sum, 1e-6) << "at " << points[i].x << ", " << points[i].y;
        }
      }
    }
  }
}

TEST_P(Surfaces, ThreadsDoNotMatter) {
  const MeshCase c = knotreel::testing::random_cases(kSurfaceSeed, 1).front();
  const Basis basis(std::make_shared<const SplineSpace>(c.mesh, GetParam()));
  const std::vector<Vec2> points = knotreel::testing::probe_points(c.mesh, kSurfaceSeed, 5000);
  const std::vector<double> control = random_control(2 * basis.space().function_count());
  std::vector<double> out[2];
  for (std::size_t i = 0; i < 2; ++i) {
    const ThreadCap cap(i == 0 ? 1 : 4);
    out[i].resize(2 * points.size());
    surface_at_points(basis, {control, 2}, points, out[i]);
  }
  EXPECT_EQ(out[0], out[1]);
}

TEST_P(Surfaces, JetsAreSumsOfJetsTimesControlPoints) {
  for (const MeshCase& c : knotreel::testing::law_cases(kSurfaceSeed, 20)) {
    SCOPED_TRACE(c.name);
    const Basis basis(std::make_shared<const SplineSpace>(c.mesh, GetParam()));
    const std::vector<double> control = random_control(2 * basis.space().function_count());
    std::vector<BasisJet> jets;
    for (const Vec2 u : knotreel::testing::probe_points(c.mesh, kSurfaceSeed, 100)) {
      const Vec2 direction = inward_direction(u, c.mesh.width, c.mesh.height);
      std::array<Jet, 2> out;
      surface_jets(basis, {control, 2}, u, direction, out);
      basis.evaluate(u, direction, jets);
      for (std::size_t k = 0; k < 2; ++k) {
        for (const auto part : {&Jet::value, &Jet::dx, &Jet::dy, &Jet::dxx, &Jet::dxy, &Jet::dyy}) {
          double sum = 0;
          double size = 0;
          for (const BasisJet& b : jets) {
            sum += b.jet.*part * control[2 * b.function + k];
            size += std::abs(b.jet.*part) * 256;
          }
          ASSERT_NEAR(out[k].*part, sum, 1e-9 * (1 + size)) << "at " << u.x << ", " << u.y;
        }
      }
    }
  }
}

TEST(Surface, WantsAsManyControlPointsAndAsMuchRoomAsItHas) {
  const MeshCase c = knotreel::testing::law_cases(kSurfaceSeed, 1).front();
  const Basis basis(std::make_shared<const SplineSpace>(c.mesh, 2));
  const std::vector<double> control = random_control(2 * basis.space().function_count());
  const std::vector<Vec2> points(3, {1, 1});
  std::vector<double> out(6);
  surface_at_points(basis, {control, 2}, points, out);
  EXPECT_THROW(surface_at_points(basis, {control, 2}, points, std::span(out).first(5)), Error);
  EXPECT_THROW(surface_at_points(basis, {control, 3}, points, out), Error);
  EXPECT_THROW(surface_at_points(basis, {control, 0}, points, out), Error);
  std::vector<Jet> jets(2);
  surface_jets(basis, {control, 2}, {1, 1}, {1, 0}, jets);
  EXPECT_THROW(surface_jets(basis, {control, 2}, {1, 1}, {1, 0}, std::span(jets).first(1)), Error);
  EXPECT_THROW(Basis(nullptr), Error);
  // Beside the domain there is no surface.
  surface_at_points(basis, {control, 2}, std::vector<Vec2>{{-1, 1}, {1, 1e9}, {std::nan(""), 1}}, out);
  EXPECT_EQ(out, std::vector<double>(6, 0));
}

}  // namespace
}  // namespace knotreel::spline
