// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/carry_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "knotreel/mesh/triangulate.h"
#include "support/mesh_cases.h"
#include "support/mesh_edits.h"

namespace knotreel::track {
namespace {

using mesh::KnotKind;
using mesh::KnotMesh;

/// A smooth motion with a whirl, stronger for larger amounts.
std::vector<Vec2> whirl(const KnotMesh& mesh, double amount, double phase) {
  std::vector<Vec2> motion;
  for (const mesh::Knot& k : mesh.knots) {
    const double x = k.position.x / mesh.width;
    const double y = k.position.y / mesh.height;
    motion.push_back({amount * std::sin(7 * y + phase), amount * std::cos(5 * x + 2 * phase)});
  }
  return motion;
}

std::map<std::uint32_t, Vec2> by_id(const KnotMesh& mesh, const std::vector<Vec2>& positions) {
  std::map<std::uint32_t, Vec2> result;
  for (std::size_t k = 0; k < positions.size(); ++k) {
    result[static_cast<std::uint32_t>(mesh.knots[k].id)] = positions[k];
  }
  return result;
}

void expect_same(const KnotMesh& a, const KnotMesh& b) {
  ASSERT_EQ(a.knots.size(), b.knots.size());
  for (std::size_t k = 0; k < a.knots.size(); ++k) {
    EXPECT_EQ(a.knots[k].position, b.knots[k].position);
    EXPECT_EQ(a.knots[k].id, b.knots[k].id);
  }
  EXPECT_EQ(a.faces.size(), b.faces.size());
}

TEST(CarryMesh, WhatDoesNotMoveStays) {
  for (const auto& c : testing::random_cases(11, 20)) {
    const std::vector<Vec2> still(c.mesh.knots.size());
    CarryReport report;
    const KnotMesh carried = carry_mesh(c.mesh, knot_targets(c.mesh, still), {}, {}, &report);
    expect_same(c.mesh, carried);
    EXPECT_EQ(report.moved + report.removed + report.held + report.flips + report.segments_dropped, 0U);
  }
}

TEST(CarryMesh, WhatRestsBesideABorderStays) {
  KnotMesh mesh = mesh::make_domain(64, 48);
  const auto add = [&](Vec2 position, mesh::KnotKind kind) {
    const auto index = static_cast<mesh::KnotIndex>(mesh.knots.size());
    mesh.knots.push_back({position, kind, mesh::KnotId{index}});
    return index;
  };
  add({0.6, 20}, mesh::KnotKind::kFree);
  const mesh::KnotIndex from = add({20, 0.7}, mesh::KnotKind::kVertex);
  const mesh::KnotIndex inside = add({20, 5.35}, mesh::KnotKind::kSegment);
  const mesh::KnotIndex to = add({20, 10}, mesh::KnotKind::kVertex);
  mesh.segments.push_back({{from, inside, to}});
  mesh::triangulate(mesh);
  std::vector<Vec2> targets;
  for (const mesh::Knot& k : mesh.knots) targets.push_back(k.position);
  const KnotMesh carried = carry_mesh(mesh, targets, {}, {});
  expect_same(mesh, carried);
  EXPECT_EQ(carried.segments.size(), 1U);
}

TEST(CarryMesh, AnyMotionGivesASoundMesh) {
  for (const double amount : {0.3, 2.0, 10.0, 60.0}) {
    for (const auto& c : testing::random_cases(12, 40)) {
      CarryReport report;
      const KnotMesh carried =
          carry_mesh(c.mesh, knot_targets(c.mesh, whirl(c.mesh, amount, amount)), {}, {}, &report);
      const auto defect = mesh::find_defect(carried);
      EXPECT_FALSE(defect) << c.name << " by " << amount << ": " << *defect;
      EXPECT_EQ(carried.knots.size() + report.removed, c.mesh.knots.size());
    }
  }
}

TEST(CarryMesh, KnotsGoWhereTheyShould) {
  int unhindered = 0;
  for (const auto& c : testing::random_cases(13, 20)) {
    const std::vector<Vec2> targets = knot_targets(c.mesh, whirl(c.mesh, 0.2, 1));
    const auto wanted = by_id(c.mesh, targets);
    CarryReport report;
    const KnotMesh carried = carry_mesh(c.mesh, targets, {}, {}, &report);
    std::size_t elsewhere = 0;
    for (const mesh::Knot& k : carried.knots) {
      elsewhere += k.position == wanted.at(static_cast<std::uint32_t>(k.id)) ? 0 : 1;
    }
    // Slowed ends take the knots between them along.
    if (report.held == 0 && report.segments_dropped == 0) {
      EXPECT_EQ(elsewhere, 0U) << c.name;
      ++unhindered;
    }
  }
  EXPECT_GE(unhindered, 10);
}

TEST(CarryMesh, EndsOfFeaturesThatComeCloseTakeNoKnotsAway) {
  testing::MeshBuilder builder(400, 300);
  const auto upper = builder.vertex(200, 149.6), lower = builder.vertex(200, 150.3);
  builder.segment(builder.vertex(200, 80), upper, 1);
  builder.segment(lower, builder.vertex(200, 220), 1);
  for (int y = 20; y < 300; y += 20) {
    for (int x = 30; x < 400; x += 20) builder.free(x, y);
  }
  const KnotMesh mesh = builder.triangulated();
  std::vector<Vec2> motion(mesh.knots.size());
  motion[upper] = {0, 0.17};  // no removal moves the two apart
  motion[lower] = {0, -0.17};
  CarryReport report;
  const KnotMesh carried = carry_mesh(mesh, knot_targets(mesh, motion), {}, {}, &report);
  EXPECT_EQ(mesh::find_defect(carried), std::nullopt);
  EXPECT_EQ(report.removed, 0U);
  EXPECT_EQ(report.held, 0U);
  EXPECT_EQ(report.moved, 4U);  // with those inside the segments
}

/// Many free knots, 8 px apart or so.
KnotMesh fine_mesh(std::mt19937& random) {
  std::uniform_real_distribution<double> apart(-3, 3);
  testing::MeshBuilder builder(400, 300);
  for (double y = 10; y < 295; y += 8) {
    for (double x = 10; x < 395; x += 8) builder.free(x + apart(random), y + apart(random));
  }
  return builder.triangulated();
}

TEST(CarryMesh, KnotsThatGoAstrayDoNotHoldTheOthers) {
  for (const unsigned seed : {1U, 2U, 3U, 4U, 5U}) {
    std::mt19937 random(seed);
    const KnotMesh mesh = fine_mesh(random);
    std::uniform_real_distribution<double> share(0, 1), astray(-60, 60);
    std::vector<Vec2> motion;
    for (const mesh::Knot& k : mesh.knots) {
      const bool in_disc = norm(k.position - Vec2{200, 150}) < 100;
      motion.push_back(in_disc && share(random) < 0.7 ? Vec2{120 + astray(random), astray(random)}
                                                      : Vec2{7, 3});
    }
    const std::vector<Vec2> targets = knot_targets(mesh, motion);
    const auto wanted = by_id(mesh, targets);
    CarryReport report;
    const KnotMesh carried = carry_mesh(mesh, targets, {}, {}, &report);
    const auto defect = mesh::find_defect(carried);
    EXPECT_FALSE(defect) << *defect;
    EXPECT_EQ(report.held, 0U) << seed;
    EXPECT_LT(report.removed, mesh.knots.size() / 2) << seed;
    for (const mesh::Knot& k : carried.knots) {
      EXPECT_EQ(k.position, wanted.at(static_cast<std::uint32_t>(k.id))) << seed;
    }
  }
}

/// Knots on the lines between others cannot always be removed.
TEST(CarryMesh, EndsWhereKnotsCannotBeRemoved) {
  for (const auto& c : testing::random_cases(17, 60)) {
    mesh::EditableMesh edited(c.mesh);
    testing::MeshEdits edits(edited, 18);
    for (int i = 0; i < 200; ++i) {
      edits.insert_on_some_edge();
      edits.flip_some_edge();
    }
    const KnotMesh mesh = edited.to_mesh();
    for (const double amount : {1.0, 3.0, 10.0}) {
      const KnotMesh carried = carry_mesh(mesh, knot_targets(mesh, whirl(mesh, amount, amount)), {});
      const auto defect = mesh::find_defect(carried);
      EXPECT_FALSE(defect) << c.name << " by " << amount << ": " << *defect;
    }
  }
}

TEST(CarryMesh, SegmentsThatCannotFollowAreTold) {
  std::size_t stuck = 0;
  for (const auto& c : testing::random_cases(16, 60)) {
    const std::vector<Vec2> targets = knot_targets(c.mesh, whirl(c.mesh, 6, 1));
    CarryReport report;
    const KnotMesh carried = carry_mesh(c.mesh, targets, {}, {}, &report);
    std::vector<Vec2> positions;
    for (const mesh::Knot& k : carried.knots) positions.push_back(k.position);
    const auto place = by_id(carried, positions);
    for (std::size_t i = 0; i < c.mesh.segments.size(); ++i) {
      if (std::find(report.stuck.begin(), report.stuck.end(), i) == report.stuck.end()) continue;
      ++stuck;
      const auto miss = [&](mesh::KnotIndex k) {
        return norm(place.at(static_cast<std::uint32_t>(c.mesh.knots[k].id)) - targets[k]);
      };
      const auto& knots = c.mesh.segments[i].knots;
      EXPECT_GE(std::max(miss(knots.front()), miss(knots.back())), 0.5) << c.name;
    }
    if (report.held == 0) {
      EXPECT_TRUE(report.stuck.empty()) << c.name;
    }
  }
  EXPECT_GT(stuck, 0U);
}

/// Two octagons, and no other knot but the corners of the picture.
KnotMesh two_octagons() {
  testing::MeshBuilder b(160, 200);
  for (const Vec2 centre : {Vec2{60.2, 60.1}, Vec2{99.7, 139.4}}) {
    std::vector<mesh::KnotIndex> corners;
    for (int i = 0; i < 8; ++i) {
      const double angle = std::numbers::pi * (i + (centre.x < 80 ? 0.3 : 0.1)) / 4;
      corners.push_back(b.vertex(centre.x + 12 * std::cos(angle), centre.y + 12 * std::sin(angle)));
    }
    for (std::size_t i = 0; i < 8; ++i) b.segment(corners[i], corners[(i + 1) % 8], 0);
  }
  return b.triangulated();
}

TEST(CarryMesh, FeaturesPassEachOther) {
  KnotMesh mesh = two_octagons();
  for (int step = 0; step < 70; ++step) {
    std::vector<Vec2> motion;
    for (const mesh::Knot& k : mesh.knots) {
      const bool corner = k.kind != KnotKind::kVertex || k.position.x == 0 || k.position.x == mesh.width;
      motion.push_back(corner ? Vec2{} : Vec2{0.1, k.position.x < 80 ? 1.0 : -1.0});
    }
    CarryReport report;
    mesh = carry_mesh(mesh, knot_targets(mesh, motion), {}, {}, &report);
    EXPECT_TRUE(report.stuck.empty()) << step;
    EXPECT_EQ(report.held, 0u) << step;
    EXPECT_FALSE(mesh::find_geometric_defect(mesh)) << step;
  }
  EXPECT_EQ(mesh.segments.size(), 16u);
}

TEST(CarryMesh, LostSegmentsBecomeOrdinaryKnots) {
  for (const auto& c : testing::random_cases(14, 20)) {
    if (c.mesh.segments.empty()) continue;
    const std::vector<Vec2> still(c.mesh.knots.size());
    const std::vector<std::uint8_t> lost(c.mesh.segments.size(), 1);
    CarryReport report;
    const KnotMesh carried = carry_mesh(c.mesh, knot_targets(c.mesh, still), lost, {}, &report);
    EXPECT_TRUE(carried.segments.empty());
    EXPECT_EQ(report.segments_dropped, c.mesh.segments.size());
    const auto defect = mesh::find_defect(carried);
    EXPECT_FALSE(defect) << c.name << ": " << *defect;
  }
}

/// What is left of a polyline must be as sound as the whole: a segment between two tips needs a knot inside.
TEST(CarryMesh, BareSegmentsGoWithTheirNeighbours) {
  testing::MeshBuilder b(100, 100);
  std::vector<mesh::KnotIndex> vertices;
  for (const Vec2 p : {Vec2{20, 40}, {40, 42}, {42, 43}, {60, 50}, {80, 50}})
    vertices.push_back(b.vertex(p.x, p.y));
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i)
    b.segment(vertices[i], vertices[i + 1], i % 2 == 0 ? 1 : 0);
  const KnotMesh mesh = b.triangulated();
  const std::vector<Vec2> targets = knot_targets(mesh, std::vector<Vec2>(mesh.knots.size()));
  for (const std::vector<std::uint8_t>& lost :
       std::vector<std::vector<std::uint8_t>>{{1, 0, 1, 0}, {1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}) {
    CarryReport report;
    const KnotMesh carried = carry_mesh(mesh, targets, lost, {}, &report);
    const auto defect = mesh::find_defect(carried);
    EXPECT_FALSE(defect) << *defect;
    const bool both = lost[0] && lost[2];
    const bool last = lost[2];
    EXPECT_EQ(report.segments_dropped, both ? 4U : last ? 2U : 1U);
  }
}

TEST(CarryMesh, TargetsKeepKnotsOnTheirLines) {
  for (const auto& c : testing::random_cases(15, 20)) {
    const std::vector<Vec2> targets = knot_targets(c.mesh, whirl(c.mesh, 3, 2));
    for (std::size_t k = 0; k < targets.size(); ++k) {
      if (c.mesh.knots[k].kind != KnotKind::kBorder) continue;
      EXPECT_EQ(targets[k], c.mesh.knots[k].position);
    }
    for (const mesh::FeatureSegment& s : c.mesh.segments) {
      const Vec2 a = targets[s.knots.front()];
      const Vec2 b = targets[s.knots.back()];
      for (const mesh::KnotIndex k : s.knots) {
        EXPECT_NEAR(cross(b - a, targets[k] - a) / norm(b - a), 0, 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace knotreel::track
