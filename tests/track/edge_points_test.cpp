// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/edge_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "track/upright_edge.h"

namespace knotreel::track {
namespace {

EdgePoints points_on(const UprightSegment& segment, const image::Image& picture) {
  return find_edge_points(*segment.basis, segment.displacement, motion::luma_of(picture));
}

double distance_from(const UprightSegment& segment, const image::Image& picture) {
  return mean_edge_distance(*segment.basis, segment.displacement, motion::luma_of(picture));
}

TEST(EdgePoints, LieOnTheEdgeNextToTheCurve) {
  const UprightSegment segment(30);
  for (const double far : {-1.0, 1.0, 2.0}) {
    const EdgePoints found = points_on(segment, upright_edge(32 + far));
    ASSERT_EQ(found.points.size(), 21u);
    for (const fit::CurvePoint& point : found.points) {
      EXPECT_NEAR(point.parameter.x, 32, 1e-9);
      EXPECT_NEAR(point.position.x, 32 + far, 0.1);
      EXPECT_NEAR(point.position.y, point.parameter.y, 1e-9);
    }
    EXPECT_NEAR(found.rms, std::abs(far), 0.1);
  }
}

TEST(EdgePoints, StayOnTheCurveWhereThereIsNoEdge) {
  const UprightSegment segment(30);
  for (const image::Image& picture : {upright_edge(60), upright_edge(32, 2)}) {
    const EdgePoints found = points_on(segment, picture);
    EXPECT_EQ(found.rms, 0);
    for (const fit::CurvePoint& point : found.points)
      EXPECT_NEAR(norm(point.position - point.parameter), 0, 1e-9);
  }
}

/// A short stretch with the edge turned round, as by something that passes, does not count.
TEST(EdgePoints, HaveTheDirectionThatMostOfTheCurveHas) {
  const UprightSegment segment(30);
  image::Image picture = upright_edge(32.5);
  const image::Image turned = upright_edge(32.5, -40);
  for (int row = 18; row < 23; ++row) {
    for (int column = 0; column < picture.width; ++column)
      picture.at(column, row, 0) = turned.at(column, row, 0);
  }
  for (const fit::CurvePoint& point : points_on(segment, picture).points) {
    if (point.parameter.y < 19 || point.parameter.y > 22) continue;
    EXPECT_NEAR(point.position.x, 32, 1e-9) << point.parameter.y;
  }
}

TEST(EdgePoints, TheMeanDistanceIsOfTheEdgesThatAreThere) {
  const UprightSegment segment(30);
  for (const double far : {-2.0, -1.0, 0.0, 1.0, 2.0})
    EXPECT_NEAR(distance_from(segment, upright_edge(32 + far)), std::abs(far), 0.1) << far;
  EXPECT_EQ(distance_from(segment, upright_edge(60)), 0);
  image::Image half = upright_edge(33);
  for (int row = 23; row < 64; ++row) {
    for (int column = 0; column < half.width; ++column) half.at(column, row, 0) = 40;
  }
  EXPECT_NEAR(distance_from(segment, half), 1, 0.1);
}

TEST(EdgePoints, WithoutCurvesThereAreNone) {
  mesh::KnotMesh mesh = mesh::make_domain(64, 64);
  mesh::triangulate(mesh);
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(mesh, 2));
  const std::vector<Vec2> displacement(basis.space().geometry_count());
  const motion::Luma luma = motion::luma_of(upright_edge(32));
  EXPECT_TRUE(find_edge_points(basis, displacement, luma).points.empty());
  EXPECT_EQ(mean_edge_distance(basis, displacement, luma), 0);
}

}  // namespace
}  // namespace knotreel::track
