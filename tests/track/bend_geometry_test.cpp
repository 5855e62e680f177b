// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/bend_geometry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

#include "support/bent_feature.h"
#include "track/carried_geometry.h"

namespace knotreel::track {
namespace {

/// A feature with a row of knots close to it on one side.
mesh::KnotMesh crowded_feature() {
  testing::MeshBuilder b(64, 48);
  b.segment(b.vertex(12, 24), b.vertex(52, 24), 3);
  for (int i = 0; i < 9; ++i) b.free(13.3 + 4.6 * i, 24.9 + 0.05 * (i % 3));
  for (int i = 0; i < 6; ++i) {
    b.free(5.1 + 10.7 * i, 10.2 + 0.6 * (i % 2));
    b.free(4.7 + 10.9 * i, 38.4 + 0.7 * (i % 2));
  }
  return b.triangulated();
}

/// Points of the feature, which is to become an arc.
std::vector<fit::CurvePoint> arc(double height) {
  std::vector<fit::CurvePoint> points;
  for (int i = 0; i <= 28; ++i) {
    const Vec2 p{12 + 40.0 * i / 28, 24};
    points.push_back({p, p + Vec2{0, height * std::sin(std::numbers::pi * i / 28)}});
  }
  return points;
}

TEST(BendGeometry, CurvesComeToTheirPointsWithoutFolds) {
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(crowded_feature(), 2));
  for (const double height : {-2.5, -1.0, 0.5, 1.0}) {
    std::vector<Vec2> displacement(basis.space().geometry_count());
    bend_geometry(basis, arc(height), displacement);
    double sum = 0;
    const std::vector<double> errors = fit::geometry_errors(basis, displacement, arc(height));
    for (const double e : errors) sum += e;
    EXPECT_LT(sum / static_cast<double>(errors.size()), 0.1 * std::abs(height)) << height;
    std::vector<Vec2> unfolded = displacement;
    EXPECT_EQ(fit::unfold_geometry(basis, unfolded), 0U) << height;
    EXPECT_TRUE(unfolded == displacement) << height << ": it had folds";
  }
}

TEST(BendGeometry, JointsBendLess) {
  const testing::BentFeature feature{{12, 26}, {30, 22}, {52, 26}};
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(feature.mesh(), 2));
  const auto bend = [&](bool joint) {
    std::vector<fit::CurvePoint> points;
    const auto add = [&](Vec2 from, Vec2 to) {
      for (int i = 0; i < 20; ++i) {
        const Vec2 u = from + (i / 20.0) * (to - from);
        points.push_back({u, {u.x, 22 + 0.01 * (u.x - 32) * (u.x - 32)}});
      }
    };
    add(feature.left, feature.middle);
    add(feature.middle, feature.right);
    points[20].joint = joint;
    std::vector<Vec2> displacement(basis.space().geometry_count());
    bend_geometry(basis, points, displacement);
    return feature.bend([&](Vec2 u) { return fit::image_points(basis, displacement, {u}).front(); });
  };
  EXPECT_GT(bend(false), 0.01);
  EXPECT_LT(bend(true), 0.85 * bend(false));
}

TEST(BendGeometry, CurvesThatStayAreAskedForAgainAndCloser) {
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(crowded_feature(), 2));
  for (const double height : {-2.0, 1.5}) {
    std::vector<Vec2> displacement(basis.space().geometry_count());
    const auto mean_error = [&] {
      const std::vector<double> errors = fit::geometry_errors(basis, displacement, arc(height));
      return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
    };
    bend_geometry(basis, arc(height), displacement);
    const double first = mean_error();
    for (int i = 0; i < 8; ++i) bend_geometry(basis, arc(height), displacement);
    EXPECT_LT(mean_error(), 0.25 * first) << height;
  }
}

TEST(BendGeometry, SidesStay) {
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(crowded_feature(), 2));
  const std::vector<Vec2> sites = basis.space().geometry_greville();
  std::vector<Vec2> displacement(sites.size());
  bend_geometry(basis, arc(2), displacement);
  for (std::size_t g = 0; g < sites.size(); ++g) {
    const Vec2 s = sites[g];
    const bool inside = s.x > 0 && s.y > 0 && s.x < 64 && s.y < 48;
    EXPECT_TRUE(inside || displacement[g] == Vec2{}) << g;
  }
}

TEST(BendGeometry, WhatNoCurveAsksForFades) {
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(crowded_feature(), 2));
  const Vec2 old{0.3, -0.4};
  std::vector<Vec2> displacement(basis.space().geometry_count(), old);
  std::vector<std::uint8_t> held(displacement.size());
  held.back() = 1;
  double before = norm(old);
  for (int i = 0; i < 3; ++i) {
    bend_geometry(basis, {}, displacement, held);
    const double now = norm(displacement.front());
    EXPECT_LT(now, before);
    EXPECT_NEAR(cross(displacement.front(), old), 0, 1e-12) << "another direction";
    before = now;
  }
  EXPECT_EQ(displacement.back(), old);
  for (int i = 0; i < 4; ++i) bend_geometry(basis, {}, displacement, held);
  displacement.pop_back();
  EXPECT_EQ(displacement, std::vector<Vec2>(displacement.size())) << "all of the others have gone";
}

TEST(BendGeometry, LargeFacesStayWhereTheyAre) {
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(crowded_feature(), 2));
  const std::vector<Vec2> sites = basis.space().geometry_greville();
  std::vector<Vec2> displacement(sites.size());
  for (int i = 0; i < 20; ++i) bend_geometry(basis, arc(2), displacement);
  std::size_t far = 0;
  for (std::size_t g = 0; g < sites.size(); ++g) {
    if (std::abs(sites[g].y - 24) < 10) continue;
    ++far;
    EXPECT_LT(norm(displacement[g]), 0.1) << sites[g].x << ' ' << sites[g].y;
  }
  EXPECT_GT(far, 10u);
}

TEST(BendGeometry, WhatIsHeldStays) {
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(crowded_feature(), 2));
  const std::vector<Vec2> sites = basis.space().geometry_greville();
  std::vector<std::uint8_t> held(sites.size());
  for (std::size_t g = 0; g < sites.size(); ++g) held[g] = sites[g].x < 30 ? 1 : 0;
  std::vector<Vec2> displacement(sites.size(), Vec2{0.125, 0});
  bend_geometry(basis, arc(2), displacement, held);
  std::size_t moved = 0;
  for (std::size_t g = 0; g < sites.size(); ++g) {
    if (held[g]) {
      EXPECT_EQ(displacement[g], (Vec2{0.125, 0})) << g;
    }
    moved += displacement[g] != Vec2{0.125, 0} ? 1 : 0;
  }
  EXPECT_GT(moved, 10u);
}

TEST(BendGeometry, WhatIsHeldIsReckonedWith) {
  // Curves lie where they belong, by what all control points do together: those that may move have nothing to
  // do, whichever others are held.
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(crowded_feature(), 2));
  const std::vector<Vec2> sites = basis.space().geometry_greville();
  std::vector<Vec2> old(sites.size());
  for (std::size_t g = 0; g < sites.size(); ++g) {
    const bool inside = sites[g].x > 0 && sites[g].y > 0 && sites[g].x < 64 && sites[g].y < 48;
    if (inside) old[g] = {0.5 + 0.01 * sites[g].x, -0.8};
  }
  std::vector<fit::CurvePoint> points = arc(0);
  for (fit::CurvePoint& p : points) p.position = fit::image_points(basis, old, {p.parameter}).front();
  const Sheet sheet{.stiffness = 0, .elasticity = 0, .inertia = 0.05};
  for (const double left : {0.0, 20.0, 30.0, 45.0}) {
    std::vector<std::uint8_t> held(sites.size());
    for (std::size_t g = 0; g < sites.size(); ++g) held[g] = sites[g].x < left ? 1 : 0;
    std::vector<Vec2> displacement = old;
    bend_geometry(basis, points, displacement, held, sheet);
    const std::vector<double> errors = fit::geometry_errors(basis, displacement, points);
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 0.02) << "held up to " << left;
  }
}

TEST(BendGeometry, DoingItAgainChangesLittle) {
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(crowded_feature(), 2));
  std::vector<Vec2> displacement(basis.space().geometry_count());
  for (int i = 0; i < 20; ++i) bend_geometry(basis, arc(2), displacement);
  std::vector<Vec2> again = displacement;
  bend_geometry(basis, arc(2), again);
  for (std::size_t g = 0; g < again.size(); ++g) EXPECT_LT(norm(again[g] - displacement[g]), 0.01) << g;
}

TEST(BendGeometry, AYieldingSheetBringsCurvesCloser) {
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(crowded_feature(), 2));
  const auto mean_error = [&](const Sheet& sheet) {
    std::vector<Vec2> displacement(basis.space().geometry_count());
    bend_geometry(basis, arc(1), displacement, {}, sheet);
    const std::vector<double> errors = fit::geometry_errors(basis, displacement, arc(1));
    return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
  };
  const double yielding = mean_error({.stiffness = 0, .elasticity = 0.03, .inertia = 0.001});
  EXPECT_LT(yielding, 0.5 * mean_error({}));
}

}  // namespace
}  // namespace knotreel::track
