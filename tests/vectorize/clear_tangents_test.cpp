// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/clear_tangents.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/mesh_cases.h"
#include "vectorize/scenes.h"

namespace knotreel::vectorize {
namespace {

using mesh::EditableMesh;
using mesh::KnotIndex;

constexpr double kRadius = 8;
constexpr double kRounding = 1e-9;

/// Circles in a row, drawn as octagons with a corner on top, and nothing else: edges of the mesh lead from
/// top to top, along the tangents of all circles.
struct Row {
  mesh::KnotMesh mesh;
  std::vector<fit::CurvePoint> curves;
  std::vector<std::uint32_t> segments;
};

Vec2 on_circle(double middle, double eighths) {
  const double angle = std::numbers::pi * eighths / 4;
  return {middle + kRadius * std::cos(angle), 60 + kRadius * std::sin(angle)};
}

Row row_of_circles() {
  Row row;
  testing::MeshBuilder b(160, 120);
  std::uint32_t segment = 0;
  for (const double middle : {40.0, 62.5, 85.0, 107.5}) {
    std::vector<KnotIndex> corners;
    for (int i = 0; i < 8; ++i) {
      const Vec2 p = on_circle(middle, i);
      corners.push_back(b.vertex(p.x, p.y));
    }
    for (std::size_t i = 0; i < 8; ++i, ++segment) {
      b.segment(corners[i], corners[(i + 1) % 8], 1);
      const Vec2 from = on_circle(middle, double(i)), to = on_circle(middle, double(i) + 1);
      for (int k = 0; k < 6; ++k) {
        row.curves.push_back(
            {from + (k / 6.0) * (to - from), on_circle(middle, double(i) + k / 6.0), k == 0});
        row.segments.push_back(segment);
      }
    }
  }
  row.mesh = b.triangulated();
  return row;
}

/// Edges from the vertices of circles that are less than 0.2 from a tangent there, on the outside.
int tangents(const mesh::KnotMesh& mesh) {
  int count = 0;
  for (const mesh::Face& f : mesh.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      const mesh::Knot& from = mesh.knots[f[i]];
      const mesh::Knot& to = mesh.knots[f[(i + 1) % 3]];
      if (from.kind != mesh::KnotKind::kVertex || on_side(mesh, from.position)) continue;
      const double middle = 40 + 22.5 * std::round((from.position.x - 40) / 22.5);
      const Vec2 out = (1 / kRadius) * (from.position - Vec2{middle, 60});
      const Vec2 way = to.position - from.position;
      const double rise = std::atan2(dot(way, out), std::abs(cross(out, way)));
      if (rise < 0.2 - kRounding && rise > -0.3) ++count;  // lower ones are sides, and inside
    }
  }
  return count;
}

knots::Target flat_target() {
  return knots::Target(draw(160, 120, 3, [](double, double) { return Colour{200, 190, 180, 255}; }), {});
}

/// Where an edge of the mesh from top to top is just right.
knots::Target two_colours() {
  return knots::Target(draw(160, 120, 3,
                            [](double, double y) {
                              return y < 60 - kRadius ? Colour{220, 200, 90} : Colour{20};
                            }),
                       {});
}

TEST(ClearTangents, EdgesAlongCurvesAreFlippedWhereThePictureIsFlat) {
  const Row row = row_of_circles();
  EXPECT_GT(tangents(row.mesh), 8);
  EditableMesh mesh(row.mesh);
  EXPECT_EQ(clear_tangents(mesh, flat_target(), row.curves, row.segments, false, 40, 1), 0U);
  const mesh::KnotMesh cleared = mesh.to_mesh();
  EXPECT_EQ(tangents(cleared), 0);
  EXPECT_FALSE(mesh::find_defect(cleared));
}

TEST(ClearTangents, KnotsComeBesideThoseThatThePictureNeeds) {
  const Row row = row_of_circles();
  EditableMesh mesh(row.mesh);
  const std::size_t inserted = clear_tangents(mesh, two_colours(), row.curves, row.segments, false, 40, 1);
  EXPECT_GT(inserted, 0U);
  const mesh::KnotMesh cleared = mesh.to_mesh();
  EXPECT_LE(tangents(cleared), 1) << "but where no knot fits in";
  EXPECT_EQ(cleared.knots.size(), row.mesh.knots.size() + inserted);
  EXPECT_EQ(cleared.segments.size(), row.mesh.segments.size());
  EXPECT_FALSE(mesh::find_defect(cleared));
  EXPECT_EQ(clear_tangents(mesh, two_colours(), row.curves, row.segments, true, 40, 1), 0U) << "it was done";
}

TEST(ClearTangents, ItDoesNotMatterWhereInASegmentAClosedCurveBegins) {
  const Row row = row_of_circles();
  constexpr std::ptrdiff_t kPoints = 48;  // of a circle
  const auto cleared = [&](std::ptrdiff_t by) {
    Row moved = row;
    for (std::ptrdiff_t i = 0; i < std::ssize(moved.curves); i += kPoints) {
      const auto curve = moved.curves.begin() + i;
      const auto segments = moved.segments.begin() + i;
      std::rotate(curve, curve + by, curve + kPoints);
      std::rotate(segments, segments + by, segments + kPoints);
    }
    EditableMesh mesh(row.mesh);
    clear_tangents(mesh, two_colours(), moved.curves, moved.segments, true, 40, 1);
    return mesh.to_mesh();
  };
  const mesh::KnotMesh expected = cleared(0);
  // Inside the segments that lead to the top of a circle and away from there, too.
  for (const std::ptrdiff_t by : {3, 33, 34, 38, 39, 45}) {
    const mesh::KnotMesh other = cleared(by);
    EXPECT_EQ(other.faces, expected.faces) << by;
    EXPECT_TRUE(
        std::ranges::equal(other.knots, expected.knots, {}, &mesh::Knot::position, &mesh::Knot::position))
        << by;
  }
}

TEST(ClearTangents, InsertsNoMoreThanItMay) {
  const Row row = row_of_circles();
  for (const std::size_t most : {0, 1, 2}) {
    EditableMesh mesh(row.mesh);
    EXPECT_EQ(clear_tangents(mesh, two_colours(), row.curves, row.segments, false, most, 1), most);
    EXPECT_FALSE(mesh::find_defect(mesh.to_mesh()));
  }
}

TEST(ClearTangents, AnyMeshStaysSound) {
  for (const auto& c : testing::fewer_if_checked(testing::random_cases(31, 60))) {
    std::vector<fit::CurvePoint> curves;
    std::vector<std::uint32_t> segments;
    for (std::uint32_t s = 0; s < c.mesh.segments.size(); ++s) {
      const Vec2 from = c.mesh.knots[c.mesh.segments[s].knots.front()].position;
      const Vec2 way = c.mesh.knots[c.mesh.segments[s].knots.back()].position - from;
      for (int k = 0; k <= 8; ++k) {
        const double t = k / 8.0;
        const Vec2 across{-way.y, way.x};
        curves.push_back({from + t * way, from + t * way + (0.4 * t * (1 - t)) * across});
        segments.push_back(s);
      }
    }
    const image::Image picture =
        draw(int(c.mesh.width), int(c.mesh.height), 1, [](double x, double y) { return Colour{x + y}; });
    EditableMesh mesh(c.mesh);
    clear_tangents(mesh, knots::Target(picture, {}), curves, segments, true, 100, 1);
    const auto defect = mesh::find_defect(mesh.to_mesh());
    EXPECT_FALSE(defect) << c.name << ": " << *defect;
  }
}

/// Things in a row, as on buttons and in lines of text: their tops were cut off where the map would have
/// folded.
TEST(ClearTangents, CirclesInARowStayRoundWhenEnlarged) {
  const auto at = [](double x, double y) -> Colour {
    for (const double radius : {4.0, 5.0, 6.0, 7.0, 8.0}) {
      const double middle = 26 * (radius - 3);
      if (std::hypot(x - middle, y - 40.5 + radius) < radius) return {30, 80, 170, 255};
    }
    return {244, 239, 230, 255};
  };
  const image::Image picture = draw(160, 60, 3, at);
  const image::Image large = draw(640, 240, 3, [&](double x, double y) { return at(x / 4, y / 4); });
  const auto psnr_of = [&](bool clear_curves) {
    Options options;
    options.clear_curves = clear_curves;
    options.longest_edge = 0;  // short edges alone do as much here
    const Vectorization made = vectorize_picture(picture, options);
    return image::compare_images(large, rendered(made.model, {.width = 640, .height = 240})).psnr;
  };
  EXPECT_GT(psnr_of(true), psnr_of(false) + 1);
}

}  // namespace
}  // namespace knotreel::vectorize
