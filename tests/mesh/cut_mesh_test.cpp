// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/cut_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "knotreel/base/error.h"
#include "support/mesh_cases.h"

/// Corners, fans and lines of cut meshes, against what the features of the mesh say.
namespace knotreel::mesh {
namespace {

using knotreel::testing::MeshBuilder;
using knotreel::testing::MeshCase;
using KnotPair = std::pair<KnotIndex, KnotIndex>;

constexpr std::uint64_t kCutMeshSeed = 20260606;

const std::vector<MeshCase>& cut_cases() {
  static const std::vector<MeshCase> all = [] {
    std::vector<MeshCase> c = knotreel::testing::corpus_cases();
    for (MeshCase& r : knotreel::testing::random_cases(kCutMeshSeed, 50)) c.push_back(std::move(r));
    return c;
  }();
  return all;
}

bool on_border(const KnotMesh& mesh, KnotIndex k) {
  const Vec2 p = mesh.knots[k].position;
  return p.x == 0 || p.y == 0 || p.x == mesh.width || p.y == mesh.height;
}

/// Walls of the cut, each with the index of its line: along segments, and edges of one face.
std::map<KnotPair, std::uint32_t> walls(const KnotMesh& mesh) {
  std::map<KnotPair, std::uint32_t> result;
  for (std::uint32_t s = 0; s < mesh.segments.size(); ++s) {
    const auto& knots = mesh.segments[s].knots;
    for (std::size_t i = 1; i < knots.size(); ++i) result[std::minmax({knots[i - 1], knots[i]})] = s;
  }
  std::map<KnotPair, int> faces;
  for (const Face& f : mesh.faces) {
    for (std::size_t i = 0; i < 3; ++i) ++faces[std::minmax({f[i], f[(i + 1) % 3]})];
  }
  const auto sides = static_cast<std::uint32_t>(mesh.segments.size());
  for (const auto& [edge, count] : faces) {
    if (count != 1) continue;
    const Vec2 a = mesh.knots[edge.first].position;
    const Vec2 b = mesh.knots[edge.second].position;
    const std::uint32_t side = a.y == 0 && b.y == 0                       ? 0
                               : a.x == mesh.width && b.x == mesh.width   ? 1
                               : a.y == mesh.height && b.y == mesh.height ? 2
                                                                          : 3;
    result[edge] = sides + side;
  }
  return result;
}

/// Corners of each knot, ascending.
std::vector<std::vector<CornerIndex>> corners_of(const KnotMesh& mesh, const CutMesh& cut) {
  std::vector<std::vector<CornerIndex>> result(mesh.knots.size());
  for (CornerIndex c = 0; c < cut.corners.size(); ++c) result[cut.corners[c].knot].push_back(c);
  return result;
}

std::size_t corner_count(const KnotMesh& mesh, KnotIndex k) {
  const CutMesh cut = cut_open(mesh);
  return corners_of(mesh, cut)[k].size();
}

TEST(CutMesh, OneCornerForAFreeKnotAndABorderKnot) {
  MeshBuilder b(100, 80);
  const KnotIndex free = b.free(40, 30);
  const KnotIndex border = b.border(30, 0);
  const KnotMesh mesh = b.triangulated();
  EXPECT_EQ(corner_count(mesh, free), 1u);
  EXPECT_EQ(corner_count(mesh, border), 1u);
  EXPECT_EQ(corner_count(mesh, 0), 1u);  // of the domain
  const CutMesh cut = cut_open(mesh);
  EXPECT_TRUE(cut.corners[free].closed);
  EXPECT_FALSE(cut.corners[free].multiple);
  EXPECT_FALSE(cut.corners[border].closed);
  EXPECT_FALSE(cut.corners[border].multiple);
  EXPECT_TRUE(cut.corners[0].multiple);
}

TEST(CutMesh, OneCornerPerSectorAtFeatures) {
  MeshBuilder b(100, 80);
  const KnotIndex tip = b.vertex(20, 20);
  const KnotIndex bend = b.vertex(40, 30);
  const KnotIndex junction = b.vertex(60, 35);
  const KnotIndex end = b.vertex(70, 80);
  b.segment(tip, bend, 1);
  b.segment(bend, junction, 0);
  b.segment(junction, end, 1);
  b.segment(junction, b.vertex(85, 20), 0);
  b.segment(junction, 1, 2);  // into a domain corner
  const KnotMesh mesh = b.triangulated();
  EXPECT_EQ(corner_count(mesh, tip), 1u);
  EXPECT_EQ(corner_count(mesh, mesh.segments[0].knots[1]), 2u);  // simple, on a segment
  EXPECT_EQ(corner_count(mesh, bend), 2u);
  EXPECT_EQ(corner_count(mesh, junction), 4u);
  EXPECT_EQ(corner_count(mesh, end), 2u);
  EXPECT_EQ(corner_count(mesh, 1), 2u);
}

TEST(CutMesh, CornerCountsFollowFromTheFeatures) {
  for (const MeshCase& c : cut_cases()) {
    const CutMesh cut = cut_open(c.mesh);
    std::vector<std::size_t> ends(c.mesh.knots.size(), 0);
    for (const FeatureSegment& s : c.mesh.segments) {
      ++ends[s.knots.front()];
      ++ends[s.knots.back()];
    }
    const auto corners = corners_of(c.mesh, cut);
    for (KnotIndex k = 0; k < c.mesh.knots.size(); ++k) {
      const KnotKind kind = c.mesh.knots[k].kind;
      const std::size_t expected = kind == KnotKind::kSegment  ? 2
                                   : kind != KnotKind::kVertex ? 1
                                   : on_border(c.mesh, k)      ? ends[k] + 1
                                                               : ends[k];
      EXPECT_EQ(corners[k].size(), expected) << "knot " << k << '\n' << c.to_text();
      for (const CornerIndex corner : corners[k]) {
        EXPECT_EQ(cut.corners[corner].multiple, kind == KnotKind::kVertex);
        EXPECT_EQ(cut.corners[corner].closed, kind == KnotKind::kFree) << c.to_text();
      }
    }
  }
}

TEST(CutMesh, FacesKeepTheirOrderAndRotation) {
  for (const MeshCase& c : cut_cases()) {
    const CutMesh cut = cut_open(c.mesh);
    ASSERT_EQ(cut.faces.size(), c.mesh.faces.size());
    for (std::size_t f = 0; f < cut.faces.size(); ++f) {
      for (std::size_t i = 0; i < 3; ++i) {
        ASSERT_EQ(cut.corners[cut.faces[f][i]].knot, c.mesh.faces[f][i]) << c.to_text();
      }
    }
  }
}

TEST(CutMesh, CornersAreNumberedByKnotThenByFirstFace) {
  for (const MeshCase& c : cut_cases()) {
    const CutMesh cut = cut_open(c.mesh);
    std::vector<std::size_t> first_face(cut.corners.size(), cut.faces.size());
    for (std::size_t f = cut.faces.size(); f-- > 0;) {
      for (const CornerIndex corner : cut.faces[f]) first_face[corner] = f;
    }
    for (CornerIndex i = 1; i < cut.corners.size(); ++i) {
      const KnotIndex before = cut.corners[i - 1].knot;
      const KnotIndex now = cut.corners[i].knot;
      EXPECT_TRUE(before < now || (before == now && first_face[i - 1] < first_face[i])) << c.to_text();
    }
  }
}

TEST(CutMesh, FacesShareEdgesExactlyWhereNoWallIs) {
  for (const MeshCase& c : cut_cases()) {
    const CutMesh cut = cut_open(c.mesh);
    const auto wall = walls(c.mesh);
    std::map<std::pair<CornerIndex, CornerIndex>, int> faces;
    for (const auto& f : cut.faces) {
      for (std::size_t i = 0; i < 3; ++i) ++faces[std::minmax({f[i], f[(i + 1) % 3]})];
    }
    for (const auto& [edge, count] : faces) {
      const KnotPair knots = std::minmax({cut.corners[edge.first].knot, cut.corners[edge.second].knot});
      EXPECT_EQ(count, wall.contains(knots) ? 1 : 2) << c.to_text();
    }
  }
}

TEST(CutMesh, FansGoRoundTheirCornersFaceByFace) {
  for (const MeshCase& c : cut_cases()) {
    SCOPED_TRACE(c.name);
    const CutMesh cut = cut_open(c.mesh);
    std::set<std::array<CornerIndex, 3>> faces;
    std::vector<std::size_t> faces_at(cut.corners.size(), 0);
    for (auto f : cut.faces) {
      for (std::size_t i = 0; i < 3; ++i) {
        ++faces_at[f[0]];
        faces.insert(f);
        std::rotate(f.begin(), f.begin() + 1, f.end());
      }
    }
    for (CornerIndex i = 0; i < cut.corners.size(); ++i) {
      const auto fan = cut.fan(i);
      const bool closed = cut.corners[i].closed;
      ASSERT_EQ(fan.size(), faces_at[i] + (closed ? 0u : 1u)) << c.to_text();
      for (std::size_t j = 0; j < faces_at[i]; ++j) {
        EXPECT_TRUE(faces.contains({i, fan[j], fan[(j + 1) % fan.size()]})) << c.to_text();
      }
      EXPECT_EQ(std::set<CornerIndex>(fan.begin(), fan.end()).size(), fan.size()) << c.to_text();
    }
  }
}

TEST(CutMesh, OpenFansRunFromCutLineToCutLine) {
  for (const MeshCase& c : cut_cases()) {
    SCOPED_TRACE(c.name);
    const CutMesh cut = cut_open(c.mesh);
    const auto wall = walls(c.mesh);
    for (CornerIndex i = 0; i < cut.corners.size(); ++i) {
      const Corner& corner = cut.corners[i];
      if (corner.closed) {
        EXPECT_EQ(corner.first_line, kNoLine);
        EXPECT_EQ(corner.last_line, kNoLine);
        continue;
      }
      const auto line_to = [&](CornerIndex other) {
        const auto it = wall.find(std::minmax({corner.knot, cut.corners[other].knot}));
        return it == wall.end() ? kNoLine : it->second;
      };
      const auto fan = cut.fan(i);
      EXPECT_NE(line_to(fan.front()), kNoLine) << c.to_text();
      EXPECT_EQ(line_to(fan.front()), corner.first_line) << c.to_text();
      EXPECT_EQ(line_to(fan.back()), corner.last_line) << c.to_text();
      for (std::size_t j = 1; j + 1 < fan.size(); ++j) EXPECT_EQ(line_to(fan[j]), kNoLine) << c.to_text();
      if (c.mesh.knots[corner.knot].kind == KnotKind::kSegment) {
        EXPECT_EQ(corner.first_line, corner.last_line);
        EXPECT_LT(corner.first_line, c.mesh.segments.size());
      }
    }
  }
}

TEST(CutMesh, LinesAreTheSegmentsAndThenTheFourSides) {
  for (const MeshCase& c : cut_cases()) {
    const CutMesh cut = cut_open(c.mesh);
    const std::size_t n = c.mesh.segments.size();
    ASSERT_EQ(cut.lines.size(), n + 4);
    for (std::size_t s = 0; s < n; ++s) {
      EXPECT_EQ(cut.lines[s].from, c.mesh.knots[c.mesh.segments[s].knots.front()].position);
      EXPECT_EQ(cut.lines[s].to, c.mesh.knots[c.mesh.segments[s].knots.back()].position);
    }
    const Vec2 corners[] = {{0, 0}, {c.mesh.width, 0}, {c.mesh.width, c.mesh.height}, {0, c.mesh.height}};
    for (std::size_t i = 0; i < 4; ++i) {
      EXPECT_EQ(cut.lines[n + i].from, corners[i]);
      EXPECT_EQ(cut.lines[n + i].to, corners[(i + 1) % 4]);
    }
  }
}

TEST(CutMesh, RefusesFacesThatDoNotJoin) {
  KnotMesh mesh = cut_cases().front().mesh;
  mesh.faces.push_back(mesh.faces.front());
  EXPECT_THROW(cut_open(mesh), Error);
}

}  // namespace
}  // namespace knotreel::mesh
