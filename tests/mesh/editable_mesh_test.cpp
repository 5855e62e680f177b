// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/editable_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "knotreel/base/error.h"
#include "mesh/canonical.h"
#include "support/mesh_cases.h"
#include "support/mesh_edits.h"

/// Single operations; editing_test.cpp has long random sequences of them.
namespace knotreel::mesh {
namespace {

using knotreel::testing::MeshBuilder;
using knotreel::testing::MeshCase;
using knotreel::testing::MeshEdits;
using Edge = EditableMesh::Edge;

constexpr std::uint64_t kEditableMeshSeed = 20261121;

const std::vector<MeshCase>& edit_cases() {
  static const std::vector<MeshCase> all = [] {
    std::vector<MeshCase> c = knotreel::testing::corpus_cases();
    for (MeshCase& r : knotreel::testing::random_cases(kEditableMeshSeed, 20)) c.push_back(std::move(r));
    return c;
  }();
  return all;
}

std::vector<Vec2> positions(const KnotMesh& mesh) {
  std::vector<Vec2> result;
  for (const Knot& k : mesh.knots) result.push_back(k.position);
  return result;
}

void expect_sound(const EditableMesh& mesh, const std::string& what) {
  const auto defect = find_defect(mesh.to_mesh());
  EXPECT_FALSE(defect) << what << ": " << *defect;
}

TEST(EditableMesh, ComesBackAsItWas) {
  for (const MeshCase& c : edit_cases()) {
    const KnotMesh back = EditableMesh(c.mesh).to_mesh();
    EXPECT_EQ(back.faces, canonical(c.mesh.faces)) << c.to_text();
    EXPECT_EQ(positions(back), positions(c.mesh));
    ASSERT_EQ(back.segments.size(), c.mesh.segments.size());
    for (std::size_t s = 0; s < back.segments.size(); ++s) {
      EXPECT_EQ(back.segments[s].knots, c.mesh.segments[s].knots);
    }
  }
}

TEST(EditableMesh, KnowsTheFixedEdges) {
  for (const MeshCase& c : edit_cases()) {
    const EditableMesh mesh(c.mesh);
    std::map<std::pair<KnotIndex, KnotIndex>, std::uint32_t> segment_of;
    for (std::uint32_t s = 0; s < c.mesh.segments.size(); ++s) {
      const auto& knots = c.mesh.segments[s].knots;
      for (std::size_t i = 1; i < knots.size(); ++i) segment_of[std::minmax({knots[i - 1], knots[i]})] = s;
    }
    for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
      for (int i = 0; i < 3; ++i) {
        const KnotIndex a = mesh.face(f)[static_cast<std::size_t>((i + 1) % 3)];
        const KnotIndex b = mesh.face(f)[static_cast<std::size_t>((i + 2) % 3)];
        const auto it = segment_of.find(std::minmax({a, b}));
        EXPECT_EQ(mesh.segment(f, i), it == segment_of.end() ? kNoSegment : it->second) << c.to_text();
        EXPECT_EQ(mesh.is_fixed({f, i}), it != segment_of.end() || mesh.neighbour(f, i) == kNoFace);
      }
    }
  }
}

TEST(EditableMesh, FlippingTwiceChangesNothing) {
  for (const MeshCase& c : edit_cases()) {
    SCOPED_TRACE(c.to_text());
    EditableMesh mesh(c.mesh);
    const std::vector<Face> before = mesh.to_mesh().faces;
    for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
      for (int i = 0; i < 3; ++i) {
        if (!mesh.can_flip({f, i})) continue;
        const FaceIndex other = mesh.neighbour(f, i);
        const Edge turned = mesh.flip({f, i});
        EXPECT_NE(mesh.to_mesh().faces, before);
        const std::set<FaceIndex> faces{turned.face, mesh.neighbour(turned.face, turned.side)};
        EXPECT_EQ(faces, (std::set<FaceIndex>{f, other})) << "still the edge between the same faces";
        ASSERT_TRUE(mesh.can_flip(turned));
        mesh.flip(turned);
        ASSERT_EQ(mesh.to_mesh().faces, before);
      }
    }
  }
}

TEST(EditableMesh, EdgesMayFlipExactlyInConvexQuadrilateralsOffTheFeatures) {
  for (const MeshCase& c : edit_cases()) {
    EditableMesh mesh(c.mesh);
    for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
      for (int i = 0; i < 3; ++i) {
        const bool may = mesh.can_flip({f, i});
        if (mesh.is_fixed({f, i})) {
          EXPECT_FALSE(may);
          continue;
        }
        const auto t = mesh.triangle(f);
        const auto at = static_cast<std::size_t>(i);
        const Edge m = mesh.mirror({f, i});
        const Vec2 p = t[at];
        const Vec2 a = t[(at + 1) % 3];
        const Vec2 b = t[(at + 2) % 3];
        const Vec2 q = mesh.triangle(m.face)[static_cast<std::size_t>(m.side)];
        const double smaller = std::min(signed_area(p, a, q), signed_area(p, q, b));
        if (std::abs(smaller) < 1e-3) continue;  // as good as collinear
        EXPECT_EQ(may, smaller > 0) << c.to_text();
      }
    }
  }
}

/// Else rounding could turn it over on any grid, and the frame could not be stored.
TEST(EditableMesh, NoFlipMakesAFaceOfThreeKnotsThatAreNearlyOnALine) {
  for (const double length : {6.0, 60.0, 600.0}) {
    for (const double height : {1e-5, 1e-4, 1e-2, 1.0}) {
      SCOPED_TRACE(std::to_string(length) + " long, " + std::to_string(height) + " high");
      MeshBuilder b(2 * length, 2 * length);
      b.free(0.5 * length, length);
      b.free(1.5 * length, length);
      const KnotIndex top = b.free(length, 0.7 * length);
      const KnotIndex middle = b.free(length, length + height);
      const EditableMesh mesh(b.triangulated());
      int found = 0;
      for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
        for (int i = 0; i < 3; ++i) {
          const Face face = mesh.face(f);
          const auto at = static_cast<std::size_t>(i);
          const std::set<KnotIndex> ends{face[(at + 1) % 3], face[(at + 2) % 3]};
          if (ends != std::set<KnotIndex>{top, middle}) continue;
          ++found;
          EXPECT_EQ(mesh.can_flip({f, i}), height >= 1e-2);
        }
      }
      EXPECT_EQ(found, 2);
    }
  }
}

TEST(EditableMesh, InsertingInAFaceAndRemovingRestoresTheMesh) {
  for (const MeshCase& c : edit_cases()) {
    SCOPED_TRACE(c.to_text());
    EditableMesh mesh(c.mesh);
    MeshEdits edits(mesh, kEditableMeshSeed);
    const std::vector<Face> faces = mesh.to_mesh().faces;
    for (int i = 0; i < 10; ++i) {
      const KnotIndex k = edits.insert_in_some_face();
      if (k == kNoKnot) continue;
      EXPECT_EQ(mesh.face_count(), faces.size() + 2);
      EXPECT_EQ(mesh.knot_count(), c.mesh.knots.size() + 1);
      ASSERT_TRUE(mesh.remove(k));
      EXPECT_FALSE(mesh.is_knot(k));
      EXPECT_EQ(mesh.to_mesh().faces, faces);
      EXPECT_EQ(positions(mesh.to_mesh()), positions(c.mesh));
    }
    EXPECT_LE(mesh.face_slots(), faces.size() + 2) << "places of faces are used again";
  }
}

TEST(EditableMesh, KnotsThatWereMadeDelaunayCanBeRemovedAgain) {
  for (const MeshCase& c : edit_cases()) {
    SCOPED_TRACE(c.to_text());
    EditableMesh mesh(c.mesh);
    MeshEdits edits(mesh, kEditableMeshSeed + 1);
    for (int i = 0; i < 10; ++i) {
      const KnotIndex k = edits.insert_in_some_face();
      if (k == kNoKnot) continue;
      mesh.legalise_around(k);
      ASSERT_TRUE(mesh.remove(k));
      EXPECT_EQ(positions(mesh.to_mesh()), positions(c.mesh));
      expect_sound(mesh, "insert, legalise, remove");
    }
  }
}

TEST(EditableMesh, InsertingOnTheBorderAndRemovingRestoresTheMesh) {
  for (const MeshCase& c : edit_cases()) {
    SCOPED_TRACE(c.to_text());
    EditableMesh mesh(c.mesh);
    const std::vector<Face> faces = mesh.to_mesh().faces;
    for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
      for (int i = 0; i < 3; ++i) {
        if (!mesh.is_face(f) || mesh.neighbour(f, i) != kNoFace) continue;  // faces change their places
        const Vec2 a = mesh.position(mesh.face(f)[static_cast<std::size_t>((i + 1) % 3)]);
        const Vec2 b = mesh.position(mesh.face(f)[static_cast<std::size_t>((i + 2) % 3)]);
        const KnotIndex k = mesh.insert_on_edge({f, i}, a + 0.3 * (b - a));
        ASSERT_EQ(mesh.knot(k).kind, KnotKind::kBorder);
        ASSERT_TRUE(mesh.remove(k));
        EXPECT_FALSE(mesh.is_knot(k));
        ASSERT_EQ(mesh.to_mesh().faces, faces);
      }
    }
    EXPECT_EQ(positions(mesh.to_mesh()), positions(c.mesh));
    EXPECT_LE(mesh.face_slots(), faces.size() + 1) << "places of faces are used again";
  }
}

TEST(EditableMesh, KnotsOnTheBorderThatWereMadeDelaunayCanBeRemovedAgain) {
  std::size_t removed = 0;
  for (const MeshCase& c : edit_cases()) {
    SCOPED_TRACE(c.to_text());
    EditableMesh mesh(c.mesh);
    for (KnotIndex k = 0; k < c.mesh.knots.size(); ++k) mesh.legalise_around(k);
    for (KnotIndex k = 0; k < c.mesh.knots.size(); ++k) {
      if (mesh.knot(k).kind != KnotKind::kBorder) continue;
      const std::size_t before = mesh.knot_count();
      const bool gone = mesh.remove(k);
      EXPECT_EQ(mesh.knot_count(), before - (gone ? 1 : 0));
      removed += gone ? 1 : 0;
      expect_sound(mesh, "remove from the border");
    }
  }
  EXPECT_GT(removed, 100u);
}

TEST(EditableMesh, KnotsOfFeaturesCannotBeRemoved) {
  for (const MeshCase& c : edit_cases()) {
    EditableMesh mesh(c.mesh);
    for (KnotIndex k = 0; k < mesh.knot_slots(); ++k) {
      if (mesh.knot(k).kind == KnotKind::kFree || mesh.knot(k).kind == KnotKind::kBorder) continue;
      EXPECT_FALSE(mesh.remove(k)) << c.to_text();
    }
    EXPECT_EQ(mesh.knot_count(), c.mesh.knots.size());
  }
}

std::vector<Face> faces_in_their_places(const EditableMesh& mesh) {
  std::vector<Face> faces;
  for (FaceIndex f = 0; f < mesh.face_slots(); ++f) faces.push_back(canonical({mesh.face(f)}).front());
  return faces;
}

/// A knot on the line of two neighbours may be left with four neighbours that no flip takes away.
TEST(EditableMesh, WhatCannotBeRemovedLeavesTheMeshAsItWas) {
  std::size_t failed = 0;
  for (const MeshCase& c : edit_cases()) {
    SCOPED_TRACE(c.to_text());
    EditableMesh mesh(c.mesh);
    MeshEdits edits(mesh, kEditableMeshSeed + 2);
    for (int i = 0; i < 40; ++i) {
      edits.insert_on_some_edge();
      edits.flip_some_edge();
    }
    const std::vector<Face> faces = faces_in_their_places(mesh);
    for (KnotIndex k = 0; k < mesh.knot_slots(); ++k) {
      EditableMesh edited(mesh);
      const KnotKind kind = mesh.knot(k).kind;
      if ((kind != KnotKind::kFree && kind != KnotKind::kBorder) || edited.remove(k)) continue;
      ++failed;
      ASSERT_EQ(faces_in_their_places(edited), faces);
      expect_sound(edited, "remove in vain");
    }
  }
  EXPECT_GT(failed, 20u);
}

TEST(EditableMesh, KnotsOnEdgesHaveTheKindOfTheEdge) {
  for (const MeshCase& c : edit_cases()) {
    SCOPED_TRACE(c.to_text());
    for (FaceIndex f = 0; f < c.mesh.faces.size(); ++f) {
      for (int i = 0; i < 3; ++i) {
        EditableMesh mesh(c.mesh);
        MeshEdits edits(mesh, kEditableMeshSeed + f);
        const bool border = mesh.neighbour(f, i) == kNoFace;
        const std::uint32_t s = mesh.segment(f, i);
        const KnotIndex k = edits.insert_on({f, i});
        if (k == kNoKnot) continue;
        EXPECT_EQ(mesh.knot(k).kind, border            ? KnotKind::kBorder
                                     : s != kNoSegment ? KnotKind::kSegment
                                                       : KnotKind::kFree);
        EXPECT_EQ(mesh.face_count(), c.mesh.faces.size() + (border ? 1 : 2));
        if (s != kNoSegment) {
          EXPECT_EQ(mesh.segments()[s].knots.size(), c.mesh.segments[s].knots.size() + 1);
        }
        expect_sound(mesh, "insert on edge");
      }
    }
  }
}

TEST(EditableMesh, KnotsOnTheBorderArePutExactlyOnIt) {
  MeshBuilder b(100, 80);
  b.free(50.3, 40.1);
  EditableMesh mesh(b.triangulated());
  const KnotIndex k = mesh.insert_on_edge(mesh.edge_between(1, 2), {99.9999999, 30});
  EXPECT_EQ(mesh.position(k), (Vec2{100, 30}));
  const KnotIndex l = mesh.insert_on_edge(mesh.edge_between(2, 3), {40, 80.0000001});
  EXPECT_EQ(mesh.position(l), (Vec2{40, 80}));
  expect_sound(mesh, "border knots");
}

TEST(EditableMesh, MovesStayOnTheirLines) {
  MeshBuilder b(100, 80);
  const KnotIndex border = b.border(100, 30);
  const KnotIndex tip = b.vertex(20, 20);
  const KnotIndex end = b.vertex(60, 50);
  b.segment(tip, end, 1);
  const KnotIndex free = b.free(80, 60);
  const KnotMesh start = b.triangulated();
  const KnotIndex inside = start.segments[0].knots[1];
  EditableMesh mesh(start);
  EXPECT_TRUE(mesh.move(border, {90, 35}));
  EXPECT_EQ(mesh.position(border), (Vec2{100, 35}));
  EXPECT_TRUE(mesh.move(inside, {45, 35}));
  const Vec2 p = mesh.position(inside);
  EXPECT_NEAR(cross(p - Vec2{20, 20}, Vec2{40, 30}), 0, 1e-10);
  EXPECT_NEAR(dot(p - Vec2{45, 35}, Vec2{40, 30}), 0, 1e-10) << "the nearest point of the line";
  EXPECT_TRUE(mesh.move(free, {81, 61}));
  EXPECT_EQ(mesh.position(free), (Vec2{81, 61}));
  expect_sound(mesh, "moves");
}

TEST(EditableMesh, RefusedMovesChangeNothing) {
  MeshBuilder b(100, 80);
  const KnotIndex border = b.border(100, 30);
  const KnotIndex tip = b.vertex(20, 20);
  const KnotIndex end = b.vertex(60, 50);
  b.segment(tip, end, 1);
  const KnotIndex free = b.free(80, 60);
  const KnotMesh start = b.triangulated();
  EditableMesh mesh(start);
  EXPECT_FALSE(mesh.move(tip, {21, 20})) << "vertices stay";
  EXPECT_FALSE(mesh.move(0, {1, 1}));
  EXPECT_FALSE(mesh.move(border, {100, 90})) << "beyond the corner";
  EXPECT_FALSE(mesh.move(border, {100, 0})) << "onto the corner";
  EXPECT_FALSE(mesh.move(start.segments[0].knots[1], {70, 57})) << "beyond the end of the segment";
  EXPECT_FALSE(mesh.move(free, {30, 20})) << "across the feature";
  EXPECT_FALSE(mesh.move(free, {80, 85})) << "out of the domain";
  EXPECT_FALSE(mesh.move(free, {80, 80})) << "onto the border: faces would be flat";
  EXPECT_EQ(positions(mesh.to_mesh()), positions(start));
}

TEST(EditableMesh, RefusesFacesThatDoNotJoinAndEdgesThatAreNone) {
  KnotMesh mesh = edit_cases().front().mesh;
  MeshBuilder b(100, 80);
  b.border(50, 0);
  const EditableMesh sound(b.triangulated());
  EXPECT_THROW(sound.edge_between(0, 1), Error) << "a knot is between";
  mesh.faces.push_back(mesh.faces.front());
  EXPECT_THROW(EditableMesh{mesh}, Error);
}

}  // namespace
}  // namespace knotreel::mesh
