// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "knotreel/mesh/knot_mesh.h"

/// Knot meshes for tests of laws: hand-made cases of every configuration of features, and random ones.
namespace knotreel::testing {

struct MeshCase {
  std::string name;
  mesh::KnotMesh mesh;  ///< triangulated and sound

  /// The case in the corpus format (tests/support/mesh_corpus.txt): paste it there to keep it.
  std::string to_text() const;
};

/// Puts knots and segments together by positions; triangulate() when all are in.
class MeshBuilder {
 public:
  MeshBuilder(double width, double height);

  mesh::KnotIndex free(double x, double y) { return add({x, y}, mesh::KnotKind::kFree); }
  mesh::KnotIndex border(double x, double y) { return add({x, y}, mesh::KnotKind::kBorder); }
  mesh::KnotIndex vertex(double x, double y) { return add({x, y}, mesh::KnotKind::kVertex); }
  void segment(mesh::KnotIndex from, mesh::KnotIndex to, int knots_inside);

  const mesh::KnotMesh& mesh() const { return mesh_; }
  /// @throws Error if the knots and segments make no sound mesh.
  mesh::KnotMesh triangulated() const;

 private:
  mesh::KnotIndex add(Vec2 p, mesh::KnotKind kind);
  mesh::KnotMesh mesh_;
};

/// The cases of the corpus file: bends, tips, junctions, loops, features that end on the border or in a
/// domain corner, close pairs, collinear free knots; and each of them mirrored and turned by a quarter.
std::vector<MeshCase> corpus_cases();

/// Random meshes of 5 to 60 free knots with up to 8 feature segments of all kinds. Deterministic.
std::vector<MeshCase> random_cases(std::uint64_t seed, int count);

/// Every third of many cases in builds with sanitizers, which are five times slower; all of them in others.
std::vector<MeshCase> fewer_if_checked(std::vector<MeshCase> cases);

/// Whether three knots lie on a straight line (to 1e-9 of its length) that is no feature segment and no side
/// of the domain: the surface is then less smooth along that line, as for any spline with collinear knots.
bool has_accidental_lines(const mesh::KnotMesh& mesh);

/// Points of the closed domain that are hard for half-open conventions: knots, edge mid-points and edge
/// points, points on feature lines and on the border, and random ones.
std::vector<Vec2> probe_points(const mesh::KnotMesh& mesh, std::uint64_t seed, int random_count);

}  // namespace knotreel::testing
