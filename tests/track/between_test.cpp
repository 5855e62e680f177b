// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/between.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "knotreel/vectorize/vectorize.h"

namespace knotreel::track {
namespace {

using document::FrameModel;
using mesh::Knot;
using mesh::KnotKind;
using mesh::KnotMesh;

/// A bright disk with a sharp edge on waves: there are features and free knots.
FrameModel disk() {
  image::Image image = image::make_image(96, 72, 1);
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      const double inside = std::clamp(18 - std::hypot(i + 0.5 - 45, j + 0.5 - 36) + 0.5, 0.0, 1.0);
      const double waves = 10 * std::sin(0.4 * i) * std::cos(0.3 * j);
      image.at(i, j, 0) = static_cast<float>(80 + (1 - inside) * waves + 120 * inside);
    }
  }
  vectorize::Options options;
  options.max_control_points = 400;
  return vectorize::vectorize_picture(image, options).model;
}

bool inner(const Knot& knot, const KnotMesh& mesh) {
  const Vec2 p = knot.position;
  return p.x > 0 && p.y > 0 && p.x < mesh.width && p.y < mesh.height;
}

/// The same frame with all knots off the border moved on, and other colours and displacements.
FrameModel moved_on(const FrameModel& model, Vec2 by, double brighter) {
  KnotMesh mesh = model.space->mesh();
  for (Knot& k : mesh.knots) {
    if (inner(k, mesh)) k.position = k.position + by;
  }
  FrameModel moved = model;
  moved.space = std::make_shared<const spline::SplineSpace>(
      spline::SplineSpace::from_link_codes(mesh, model.space->degree(), model.space->link_codes()));
  for (double& c : moved.colour) c += brighter;
  for (Vec2& d : moved.displacement) d = d + Vec2{0.1, 0.2};
  return moved;
}

std::vector<Vec2> positions(const FrameModel& model) {
  std::vector<Vec2> all;
  for (const Knot& k : model.space->mesh().knots) all.push_back(k.position);
  return all;
}

void expect_equal(const FrameModel& a, const FrameModel& b) {
  EXPECT_EQ(positions(a), positions(b));
  EXPECT_EQ(a.space->mesh().faces, b.space->mesh().faces);
  EXPECT_EQ(a.displacement, b.displacement);
  EXPECT_EQ(a.colour, b.colour);
}

TEST(Between, TheEndsAreTheFrames) {
  const FrameModel a = disk();
  const FrameModel b = moved_on(a, {0.2, -0.1}, 10);
  expect_equal(between(a, b, 0), a);
  expect_equal(between(a, b, 1), b);
}

TEST(Between, WhatMovesIsOnItsWay) {
  const FrameModel a = disk();
  ASSERT_FALSE(a.space->mesh().segments.empty());
  const FrameModel b = moved_on(a, {0.2, -0.1}, 10);
  ASSERT_FALSE(mesh::find_defect(b.space->mesh()).has_value());
  for (const double share : {0.25, 0.5, 0.8}) {
    const FrameModel m = between(a, b, share);
    EXPECT_FALSE(mesh::find_defect(m.space->mesh()).has_value());
    for (std::size_t k = 0; k < positions(m).size(); ++k) {
      const Vec2 way = positions(b)[k] - positions(a)[k];
      EXPECT_NEAR(norm(positions(m)[k] - positions(a)[k] - share * way), 0, 1e-9) << k;
    }
    for (std::size_t i = 0; i < m.colour.size(); ++i)
      EXPECT_NEAR(m.colour[i], a.colour[i] + 10 * share, 1e-9);
    for (std::size_t i = 0; i < m.displacement.size(); ++i) {
      EXPECT_NEAR(norm(m.displacement[i] - a.displacement[i] - share * Vec2{0.1, 0.2}), 0, 1e-9);
    }
  }
}

TEST(Between, KnotsOfOneFrameOnlyGoAlong) {
  const FrameModel a = disk();
  FrameModel b = moved_on(a, {0.2, -0.1}, 0);
  KnotMesh mesh = b.space->mesh();
  std::size_t renamed = mesh.knots.size();
  for (std::size_t k = 0; k < mesh.knots.size() && renamed == mesh.knots.size(); ++k) {
    bool near_border = false;
    for (const mesh::Face& f : mesh.faces) {
      if (std::find(f.begin(), f.end(), k) == f.end()) continue;
      for (const mesh::KnotIndex i : f) near_border = near_border || !inner(mesh.knots[i], mesh);
    }
    if (mesh.knots[k].kind == KnotKind::kFree && !near_border) renamed = k;
  }
  ASSERT_LT(renamed, mesh.knots.size());
  mesh.knots[renamed].id = mesh::KnotId{1000000};
  b.space = std::make_shared<const spline::SplineSpace>(
      spline::SplineSpace::from_link_codes(mesh, b.space->degree(), b.space->link_codes()));
  const Vec2 way = positions(between(a, b, 0.4))[renamed] - positions(a)[renamed];
  EXPECT_NEAR(norm(way - Vec2{0.08, -0.04}), 0, 1e-9);
}

TEST(Between, TheMeshIsSoundWhateverTheFrames) {
  const FrameModel a = disk();
  FrameModel b = a;
  KnotMesh mesh = a.space->mesh();
  // The other frame has the same names at wholly other places.
  std::vector<std::size_t> free;
  for (std::size_t k = 0; k < mesh.knots.size(); ++k) {
    if (mesh.knots[k].kind == KnotKind::kFree) free.push_back(k);
  }
  ASSERT_GT(free.size(), 20u);
  for (std::size_t i = 0; i < free.size() / 2; ++i) {
    std::swap(mesh.knots[free[i]].id, mesh.knots[free[free.size() - 1 - i]].id);
  }
  b.space = std::make_shared<const spline::SplineSpace>(
      spline::SplineSpace::from_link_codes(mesh, a.space->degree(), a.space->link_codes()));
  for (const double share : {0.1, 0.4, 0.6, 0.9}) {
    EXPECT_FALSE(mesh::find_defect(between(a, b, share).space->mesh()).has_value()) << share;
  }
}

TEST(Between, WhatIsNoFrameOrNotBetweenIsRefused) {
  const FrameModel a = disk();
  EXPECT_THROW(between(a, FrameModel{}, 0.3), Error);
  EXPECT_THROW(between(a, a, 1.5), Error);
  EXPECT_THROW(between(a, a, std::nan("")), Error);
}

TEST(Between, FramesOfOtherDocumentsAreRefused) {
  const FrameModel a = disk();
  FrameModel coloured = a;
  coloured.channels = 3;
  coloured.colour.resize(3 * a.colour.size());
  mesh::KnotMesh larger = a.space->mesh();
  for (Knot& k : larger.knots) k.position = 2.0 * k.position;
  larger.width *= 2;
  larger.height *= 2;
  FrameModel large = a;
  large.space = std::make_shared<const spline::SplineSpace>(larger, a.space->degree());
  large.displacement.resize(large.space->geometry_count());
  large.colour.resize(large.space->function_count());
  FrameModel linear = a;
  linear.space = std::make_shared<const spline::SplineSpace>(a.space->mesh(), 1);
  linear.displacement.resize(linear.space->geometry_count());
  linear.colour.resize(linear.space->function_count());
  for (const FrameModel& other : {coloured, large, linear}) {
    ASSERT_FALSE(document::find_defect(other).has_value());
    EXPECT_THROW(between(a, other, 0.3), Error);
    EXPECT_THROW(between(other, a, 0.3), Error);
  }
}

}  // namespace
}  // namespace knotreel::track
