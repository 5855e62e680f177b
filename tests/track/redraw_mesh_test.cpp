// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/redraw_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "support/mesh_cases.h"

namespace knotreel::track {
namespace {

using knotreel::testing::MeshBuilder;
using mesh::KnotKind;
using mesh::KnotMesh;

constexpr std::uint32_t kNextId = 1000;

std::vector<Vec2> positions(const KnotMesh& mesh) {
  std::vector<Vec2> result;
  for (const mesh::Knot& k : mesh.knots) result.push_back(k.position);
  return result;
}

/// The features of a mesh alone.
KnotMesh features_of(const KnotMesh& mesh, Vec2 shift = {}) {
  MeshBuilder b(mesh.width, mesh.height);
  std::map<mesh::KnotIndex, mesh::KnotIndex> vertices;
  const auto vertex = [&](mesh::KnotIndex k) {
    const Vec2 p = mesh.knots[k].position;
    for (mesh::KnotIndex c = 0; c < 4; ++c)
      if (b.mesh().knots[c].position == p) return c;
    if (!vertices.count(k)) vertices[k] = b.vertex(p.x + shift.x, p.y + shift.y);
    return vertices[k];
  };
  for (const mesh::FeatureSegment& s : mesh.segments)
    b.segment(vertex(s.knots.front()), vertex(s.knots.back()), int(s.knots.size()) - 2);
  return b.triangulated();
}

std::map<std::uint32_t, mesh::Knot> by_id(const KnotMesh& mesh) {
  std::map<std::uint32_t, mesh::Knot> result;
  for (const mesh::Knot& k : mesh.knots) result.emplace(static_cast<std::uint32_t>(k.id), k);
  return result;
}

struct Redrawn {
  KnotMesh mesh;
  CarryReport report;
  std::uint32_t next_id = kNextId;
};

Redrawn redraw(const KnotMesh& features, const KnotMesh& before, const std::vector<Vec2>& targets,
               double least = 1.5) {
  Redrawn r;
  const auto mesh = redraw_mesh(features, before, targets, {.min_distance = least}, r.next_id, r.report);
  EXPECT_TRUE(mesh);
  r.mesh = mesh.value_or(before);
  EXPECT_EQ(mesh::find_defect(r.mesh), std::nullopt);
  return r;
}

TEST(RedrawMesh, TheSameFeaturesWithoutMotionKeepAllNamesAndPlaces) {
  for (const auto& c : knotreel::testing::random_cases(31, 40)) {
    const Redrawn r = redraw(features_of(c.mesh), c.mesh, positions(c.mesh), 1e-6);
    const auto before = by_id(c.mesh);
    const auto after = by_id(r.mesh);
    ASSERT_EQ(after.size(), before.size()) << c.name;
    for (const auto& [id, knot] : before) {
      ASSERT_TRUE(after.count(id)) << c.name << ", knot " << id;
      EXPECT_LT(norm(after.at(id).position - knot.position), 1e-9) << c.name << ", knot " << id;
      EXPECT_EQ(after.at(id).kind, knot.kind) << c.name;
    }
    EXPECT_EQ(r.next_id, kNextId) << c.name;
    EXPECT_EQ(r.report.removed, 0U) << c.name;
  }
}

TEST(RedrawMesh, AnyFeaturesAndAnyMotionGiveASoundMesh) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> jump(-20, 20);
  const auto cases = knotreel::testing::random_cases(32, 40);
  for (std::size_t i = 0; i + 1 < cases.size(); ++i) {
    const KnotMesh& before = cases[i].mesh;
    KnotMesh features = features_of(cases[i + 1].mesh);
    if (features.width != before.width || features.height != before.height) features = features_of(before);
    std::vector<Vec2> motion;
    for (std::size_t k = 0; k < before.knots.size(); ++k) motion.push_back({jump(random), jump(random)});
    const Redrawn r = redraw(features, before, knot_targets(before, motion));
    std::set<std::uint32_t> ids;
    for (const mesh::Knot& k : r.mesh.knots)
      EXPECT_TRUE(ids.insert(static_cast<std::uint32_t>(k.id)).second) << cases[i].name;
    EXPECT_EQ(r.mesh.segments.size(), features.segments.size());
  }
}

KnotMesh before_mesh() {
  MeshBuilder b(64, 48);
  b.segment(b.vertex(10, 24), b.vertex(50, 24), 3);
  b.free(20, 10);
  b.free(30, 36);
  b.border(32, 0);
  return b.triangulated();
}

TEST(RedrawMesh, FeaturesAreTheNewOnesAndFreeKnotsGoWithTheMotion) {
  const KnotMesh before = before_mesh();
  std::vector<Vec2> motion(before.knots.size(), Vec2{2, 1});
  // Half a pixel beside where the motion takes the old ones.
  const Redrawn r = redraw(features_of(before, {2.5, 1}), before, knot_targets(before, motion));
  const auto old = by_id(before);
  const auto now = by_id(r.mesh);
  EXPECT_EQ(now.size(), old.size());
  for (const auto& [id, knot] : old) {
    ASSERT_TRUE(now.count(id)) << id;
    const Vec2 moved = now.at(id).position - knot.position;
    const bool on_feature = knot.kind == KnotKind::kSegment || (knot.kind == KnotKind::kVertex && id >= 4);
    if (on_feature) {
      EXPECT_LT(norm(moved - Vec2{2.5, 1}), 1e-9) << id;
    } else if (knot.kind == KnotKind::kFree) {
      EXPECT_EQ(moved, (Vec2{2, 1})) << id;
    } else {
      EXPECT_EQ(moved, Vec2{}) << id;
    }
  }
}

TEST(RedrawMesh, KnotsOfFeaturesThatAreElsewhereAreNew) {
  const KnotMesh before = before_mesh();
  const Redrawn r = redraw(features_of(before, {0, 5}), before, positions(before));
  EXPECT_EQ(r.next_id, kNextId + 5);
  const auto old = by_id(before);
  for (const auto& [id, knot] : by_id(r.mesh)) {
    const bool on_feature = knot.kind == KnotKind::kSegment || (knot.kind == KnotKind::kVertex && id >= 4);
    EXPECT_EQ(old.count(id), on_feature ? 0U : 1U) << id;
  }
}

TEST(RedrawMesh, ASegmentThatNeedsMoreKnotsHasNewOnesBetweenItsVertices) {
  const KnotMesh before = before_mesh();
  MeshBuilder b(64, 48);
  b.segment(b.vertex(50, 24), b.vertex(10, 24), 4);
  const Redrawn r = redraw(b.triangulated(), before, positions(before));
  EXPECT_EQ(r.next_id, kNextId + 4);
}

/// Knots inside segments settle, and come where the error is.
TEST(RedrawMesh, ASegmentKeepsTheKnotsThatItHadInside) {
  KnotMesh before = before_mesh();
  const std::vector<mesh::KnotIndex> inside(before.segments[0].knots.begin() + 1,
                                            before.segments[0].knots.end() - 1);
  ASSERT_EQ(inside.size(), 3U);
  before.knots[inside[1]].position.x += 3.3;
  for (const int wanted : {1, 2, 3}) {
    for (const Vec2 shift : {Vec2{0, 0}, Vec2{1.2, 0.7}}) {
      MeshBuilder b(64, 48);
      b.segment(b.vertex(50 + shift.x, 24 + shift.y), b.vertex(10 + shift.x, 24 + shift.y), wanted);
      const Redrawn r = redraw(b.triangulated(), before, positions(before));
      const auto now = by_id(r.mesh);
      for (const mesh::KnotIndex k : inside) {
        const auto found = now.find(static_cast<std::uint32_t>(before.knots[k].id));
        ASSERT_NE(found, now.end()) << wanted;
        const Vec2 moved = found->second.position - before.knots[k].position;
        if (shift == Vec2{}) {
          EXPECT_EQ(moved, Vec2{}) << "bit for bit";
        } else {
          EXPECT_LT(norm(moved - shift), 1e-9);
        }
      }
      EXPECT_EQ(r.next_id, kNextId);
    }
  }
  // But not in a heap.
  MeshBuilder b(64, 48);
  b.segment(b.vertex(10, 24), b.vertex(12.4, 24), 1);
  std::vector<Vec2> targets = positions(before);
  for (std::size_t k = 0; k < targets.size(); ++k)
    if (before.knots[k].position == Vec2{50, 24}) targets[k] = {12.4, 24};
  const Redrawn r = redraw(b.triangulated(), before, targets);
  EXPECT_EQ(r.mesh.segments[0].knots.size(), 3U);
}

TEST(RedrawMesh, ASegmentDrawnTheOtherWayRoundKeepsItsNames) {
  const KnotMesh before = before_mesh();
  MeshBuilder b(64, 48);
  b.segment(b.vertex(50, 24), b.vertex(10, 24), 3);
  const Redrawn r = redraw(b.triangulated(), before, positions(before));
  const auto old = by_id(before);
  for (const auto& [id, knot] : by_id(r.mesh))
    EXPECT_LT(norm(knot.position - old.at(id).position), 1e-9) << id;
}

TEST(RedrawMesh, FreeKnotsInTheWayGo) {
  const KnotMesh before = before_mesh();
  std::vector<Vec2> targets = positions(before);
  for (std::size_t k = 0; k < targets.size(); ++k) {
    if (targets[k] == Vec2{20, 10}) targets[k] = {20, 25};    // a pixel from the feature
    if (targets[k] == Vec2{30, 36}) targets[k] = {63.5, 36};  // half a pixel from a side
  }
  const Redrawn r = redraw(features_of(before), before, targets);
  EXPECT_EQ(r.report.removed, 2U);
  EXPECT_EQ(r.mesh.knots.size(), before.knots.size() - 2);
}

TEST(RedrawMesh, FlatFacesAreRefused) {
  const KnotMesh before = before_mesh();
  for (const double gap : {1e-2, 1e-4}) {
    MeshBuilder b(64, 48);  // two features that all but touch
    b.segment(b.vertex(10, 24), b.vertex(50, 24), 1);
    b.segment(b.vertex(10, 24 + gap), b.vertex(50, 24 + gap), 1);
    std::uint32_t next_id = kNextId;
    CarryReport report;
    const auto mesh = redraw_mesh(b.triangulated(), before, positions(before), {}, next_id, report);
    EXPECT_EQ(mesh.has_value(), gap > 1e-3) << gap;
  }
}

}  // namespace
}  // namespace knotreel::track
