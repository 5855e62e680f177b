// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "knotreel/base/error.h"
#include "knotreel/mesh/editable_mesh.h"
#include "knotreel/mesh/predicates.h"
#include "knotreel/mesh/triangulate.h"
#include "support/mesh_cases.h"
#include "support/mesh_edits.h"

/// Long random sequences of edits.
namespace knotreel::mesh {
namespace {

using knotreel::testing::MeshCase;
using knotreel::testing::MeshEdits;
using Edge = EditableMesh::Edge;

constexpr std::uint64_t kEditingSeed = 20261122;

std::vector<MeshCase> cases(int random_count) {
  std::vector<MeshCase> c = knotreel::testing::corpus_cases();
  for (MeshCase& r : knotreel::testing::random_cases(kEditingSeed, random_count)) c.push_back(std::move(r));
  return c;
}

/// Neighbours name each other and agree on the edge between them.
void check_edges(const EditableMesh& mesh) {
  for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    if (!mesh.is_face(f)) continue;
    for (int i = 0; i < 3; ++i) {
      const KnotIndex a = mesh.face(f)[static_cast<std::size_t>((i + 1) % 3)];
      const KnotIndex b = mesh.face(f)[static_cast<std::size_t>((i + 2) % 3)];
      const Edge between = mesh.edge_between(a, b);
      if (mesh.neighbour(f, i) == kNoFace) {
        ASSERT_EQ(between.face, f);
        ASSERT_EQ(between.side, i);
        continue;
      }
      const Edge m = mesh.mirror({f, i});
      ASSERT_TRUE(mesh.is_face(m.face));
      const Edge back = mesh.mirror(m);
      ASSERT_EQ(back.face, f);
      ASSERT_EQ(back.side, i);
      ASSERT_EQ(mesh.face(m.face)[static_cast<std::size_t>((m.side + 1) % 3)], b);
      ASSERT_EQ(mesh.face(m.face)[static_cast<std::size_t>((m.side + 2) % 3)], a);
      ASSERT_EQ(mesh.segment(f, i), mesh.segment(m.face, m.side));
      ASSERT_TRUE((between.face == f && between.side == i) ||
                  (between.face == m.face && between.side == m.side));
    }
  }
}

/// faces_around() gives all faces of each knot, each next to the one before, and starts on the border.
void check_fans(const EditableMesh& mesh) {
  std::vector<std::set<FaceIndex>> faces(mesh.knot_slots());
  for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    if (!mesh.is_face(f)) continue;
    for (const KnotIndex k : mesh.face(f)) faces[k].insert(f);
  }
  std::vector<FaceIndex> fan;
  for (KnotIndex k = 0; k < mesh.knot_slots(); ++k) {
    if (!mesh.is_knot(k)) continue;
    mesh.faces_around(k, fan);
    ASSERT_EQ(fan.size(), faces[k].size());
    ASSERT_EQ(std::set<FaceIndex>(fan.begin(), fan.end()), faces[k]);
    const auto corner = [&](FaceIndex f, std::size_t after) {
      const Face& v = mesh.face(f);
      const auto at = static_cast<std::size_t>(std::find(v.begin(), v.end(), k) - v.begin());
      return v[(at + after) % 3];
    };
    for (std::size_t i = 1; i < fan.size(); ++i) ASSERT_EQ(corner(fan[i - 1], 2), corner(fan[i], 1));
    const Vec2 p = mesh.position(k);
    const bool border = p.x == 0 || p.y == 0 || p.x == mesh.width() || p.y == mesh.height();
    ASSERT_EQ(corner(fan.back(), 2) == corner(fan.front(), 1), !border);
  }
}

/// Segments run from their old first to their old last knot, through all their old knots, and forward.
void check_segments(const EditableMesh& mesh, const KnotMesh& start) {
  ASSERT_EQ(mesh.segments().size(), start.segments.size());
  for (std::size_t s = 0; s < start.segments.size(); ++s) {
    const auto& knots = mesh.segments()[s].knots;
    const auto& before = start.segments[s].knots;
    ASSERT_EQ(knots.front(), before.front());
    ASSERT_EQ(knots.back(), before.back());
    auto at = knots.begin();
    for (const KnotIndex k : before) {
      at = std::find(at, knots.end(), k);
      ASSERT_NE(at, knots.end()) << "knot " << k << " is lost or out of order";
    }
    const Vec2 along = mesh.position(knots.back()) - mesh.position(knots.front());
    for (std::size_t i = 1; i < knots.size(); ++i) {
      ASSERT_GT(dot(mesh.position(knots[i]) - mesh.position(knots[i - 1]), along), 0);
    }
  }
}

TEST(Editing, AnySequenceOfEditsKeepsTheMeshSound) {
  std::uint64_t seed = kEditingSeed;
  for (const MeshCase& c : cases(30)) {
    SCOPED_TRACE("seed " + std::to_string(++seed) + '\n' + c.to_text());
    EditableMesh mesh(c.mesh);
    MeshEdits edits(mesh, seed);
    std::map<KnotIndex, KnotId> ids;
    for (int i = 0; i < 120; ++i) {
      const std::string what = edits.step();
      for (KnotIndex k = 0; k < mesh.knot_slots(); ++k) {
        if (!mesh.is_knot(k)) continue;
        ASSERT_EQ(ids.emplace(k, mesh.knot(k).id).first->second, mesh.knot(k).id) << "ids are stable";
      }
      if (i % 8 != 7) continue;
      const KnotMesh now = mesh.to_mesh();
      const auto defect = find_defect(now);
      ASSERT_FALSE(defect) << *defect << " after edit " << i << ": " << what;
      ASSERT_EQ(now.knots.size(), mesh.knot_count());
      ASSERT_EQ(now.faces.size(), mesh.face_count());
      check_edges(mesh);
      check_fans(mesh);
      check_segments(mesh, c.mesh);
      if (HasFatalFailure()) FAIL() << "after edit " << i << ": " << what;
    }
    std::set<KnotId> all;
    for (const auto& [k, id] : ids)
      EXPECT_TRUE(all.insert(id).second) << "ids of removed knots do not return";
  }
}

TEST(Editing, MeshesCanBeTakenUpAgain) {
  for (const MeshCase& c : cases(5)) {
    SCOPED_TRACE(c.to_text());
    EditableMesh mesh(c.mesh);
    MeshEdits edits(mesh, kEditingSeed);
    for (int i = 0; i < 30; ++i) edits.step();
    const KnotMesh saved = mesh.to_mesh();
    EditableMesh again(saved);
    MeshEdits more(again, kEditingSeed + 1);
    for (int i = 0; i < 30; ++i) more.step();
    const auto defect = find_defect(again.to_mesh());
    EXPECT_FALSE(defect) << *defect;
  }
}

/// What the constrained Delaunay property says about the edges that may be flipped.
enum class Delaunay { kNo, kWithTies, kUnique };

Delaunay check_delaunay(const EditableMesh& mesh) {
  Delaunay result = Delaunay::kUnique;
  for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    for (int i = 0; i < 3; ++i) {
      if (!mesh.can_flip({f, i})) continue;
      const auto t = mesh.triangle(f);
      const auto at = static_cast<std::size_t>(i);
      const Edge m = mesh.mirror({f, i});
      const Vec2 q = mesh.triangle(m.face)[static_cast<std::size_t>(m.side)];
      if (in_circle(t[0], t[1], t[2], q)) return Delaunay::kNo;
      if (!in_circle(t[at], t[(at + 1) % 3], q, t[(at + 2) % 3])) result = Delaunay::kWithTies;
    }
  }
  return result;
}

TEST(Editing, InsertedKnotsBecomeDelaunay) {
  int compared = 0;
  std::uint64_t seed = kEditingSeed;
  for (const MeshCase& c : cases(60)) {
    SCOPED_TRACE("seed " + std::to_string(++seed) + '\n' + c.to_text());
    EditableMesh mesh(c.mesh);
    MeshEdits edits(mesh, seed);
    if (check_delaunay(mesh) == Delaunay::kNo) continue;  // flat quadrilaterals along collinear knots
    for (int i = 0; i < 40; ++i) {
      const KnotIndex k = i % 4 == 0 ? edits.insert_on_some_edge() : edits.insert_in_some_face();
      if (k == kNoKnot) continue;
      mesh.legalise_around(k);
      ASSERT_NE(check_delaunay(mesh), Delaunay::kNo) << "knot " << k;
    }
    if (check_delaunay(mesh) != Delaunay::kUnique) continue;
    KnotMesh from_scratch = mesh.to_mesh();
    const std::vector<Face> faces = from_scratch.faces;
    triangulate(from_scratch);
    for (Face& f : from_scratch.faces) std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    std::sort(from_scratch.faces.begin(), from_scratch.faces.end());
    EXPECT_EQ(faces, from_scratch.faces);
    ++compared;
  }
  EXPECT_GT(compared, 40);
}

TEST(Editing, WithoutFeaturesNoKnotIsInsideTheCircleOfAFace) {
  MeshCase c{"plain", make_domain(100, 80)};
  triangulate(c.mesh);
  EditableMesh mesh(c.mesh);
  MeshEdits edits(mesh, kEditingSeed);
  while (mesh.knot_count() < 150) {
    const KnotIndex k = edits.insert_in_some_face();
    if (k != kNoKnot) mesh.legalise_around(k);
  }
  for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    const auto [a, b, c3] = mesh.triangle(f);
    for (KnotIndex k = 0; k < mesh.knot_slots(); ++k) EXPECT_FALSE(in_circle(a, b, c3, mesh.position(k)));
  }
}

}  // namespace
}  // namespace knotreel::mesh
