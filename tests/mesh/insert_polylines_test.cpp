// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/insert_polylines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/mesh_cases.h"

namespace knotreel::mesh {
namespace {

constexpr std::uint64_t kInsertPolylinesSeed = 20261121;

std::vector<Vec2> random_walk(const KnotMesh& mesh, std::mt19937_64& random) {
  const auto uniform = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  std::vector<Vec2> line{{uniform(0, mesh.width), uniform(0, mesh.height)}};
  double heading = uniform(0, 6.28);
  const int pieces = std::uniform_int_distribution<int>(1, 5)(random);
  for (int i = 0; i < pieces; ++i) {
    const double length = uniform(1, 0.3 * std::min(mesh.width, mesh.height));
    line.push_back(line.back() + length * Vec2{std::cos(heading), std::sin(heading)});
    heading += uniform(-1.8, 1.8);
  }
  return line;
}

double distance_to_line(Vec2 p, const std::vector<Vec2>& line) {
  double least = 1e300;
  for (std::size_t i = 1; i < line.size(); ++i) {
    const Vec2 along = line[i] - line[i - 1];
    const double t = std::clamp(dot(p - line[i - 1], along) / dot(along, along), 0.0, 1.0);
    least = std::min(least, norm(p - (line[i - 1] + t * along)));
  }
  return least;
}

TEST(InsertPolylines, MeshesStaySoundAndHoldThem) {
  std::mt19937_64 random(kInsertPolylinesSeed);
  std::size_t taken = 0;
  for (const auto& c : knotreel::testing::random_cases(kInsertPolylinesSeed, 150)) {
    SCOPED_TRACE(c.name + "\n" + c.to_text());
    std::vector<std::vector<Vec2>> lines;
    for (int i = 0; i < 6; ++i) lines.push_back(random_walk(c.mesh, random));
    EditableMesh mesh(c.mesh, 1000);
    const InsertOptions options{.clearance = 2};
    const auto knots = insert_polylines(mesh, lines, options);
    const KnotMesh result = mesh.to_mesh();
    ASSERT_EQ(find_defect(result), std::nullopt);
    ASSERT_EQ(knots.size(), lines.size());
    std::size_t pieces = 0;
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (knots[i].empty()) continue;
      ++taken;
      pieces += lines[i].size() - 1;
      EXPECT_NEAR(norm(mesh.position(knots[i].front()) - lines[i].front()), 0, 0.02);
      EXPECT_NEAR(norm(mesh.position(knots[i].back()) - lines[i].back()), 0, 0.02);
      for (const KnotIndex k : knots[i]) EXPECT_LT(distance_to_line(mesh.position(k), lines[i]), 0.02);
    }
    EXPECT_EQ(result.segments.size(), c.mesh.segments.size() + pieces);
    // What was there before is there still, but for free knots in the way.
    for (std::size_t s = 0; s < c.mesh.segments.size(); ++s) {
      EXPECT_EQ(mesh.segments()[s].knots, c.mesh.segments[s].knots);
    }
    for (KnotIndex k = 0; k < c.mesh.knots.size(); ++k) {
      if (mesh.is_knot(k)) {
        EXPECT_EQ(mesh.knot(k).id, c.mesh.knots[k].id);
      } else {
        EXPECT_EQ(c.mesh.knots[k].kind, KnotKind::kFree);
      }
    }
  }
  EXPECT_GT(taken, 250U) << "of 900; most others are too near to something";
}

TEST(InsertPolylines, WhatIsTooNearIsLeftOut) {
  knotreel::testing::MeshBuilder builder(60, 40);
  const KnotIndex a = builder.vertex(10, 20);
  const KnotIndex b = builder.vertex(30, 20);
  builder.segment(a, b, 1);
  builder.free(45, 20);
  const KnotMesh before = builder.triangulated();
  const std::vector<std::vector<Vec2>> lines{
      {{20, 10}, {20, 30}},                     // crosses the segment
      {{10, 22}, {30, 22}},                     // beside it
      {{1, 5}, {1, 15}},                        // at the border
      {{40, 10}, {50, 10}, {41, 11}},           // turns back
      {{40, 10}, {50, 10}, {50, 16}, {45, 9}},  // crosses itself
      {{40, 10}},                               // no line
      {{45.5, 12}, {45.5, 30}},                 // fits, though a free knot is in the way
      {{47, 12}, {47, 30}},                     // beside the one before
  };
  EditableMesh mesh(before);
  const auto knots = insert_polylines(mesh, lines);
  ASSERT_EQ(knots.size(), lines.size());
  for (std::size_t i = 0; i < lines.size(); ++i) EXPECT_EQ(knots[i].empty(), i != 6) << i;
  EXPECT_EQ(find_defect(mesh.to_mesh()), std::nullopt);
  EXPECT_EQ(mesh.segments().size(), 2U);
  EditableMesh untouched(before);
  insert_polylines(untouched, std::span(lines).first(6));
  EXPECT_EQ(untouched.to_mesh().faces, EditableMesh(before).to_mesh().faces);
}

}  // namespace
}  // namespace knotreel::mesh
