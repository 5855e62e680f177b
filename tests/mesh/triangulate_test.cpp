// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/triangulate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "knotreel/base/error.h"
#include "mesh/canonical.h"
#include "support/mesh_cases.h"

namespace knotreel::mesh {
namespace {

using knotreel::testing::MeshBuilder;
using knotreel::testing::MeshCase;
using KnotPair = std::pair<KnotIndex, KnotIndex>;

constexpr std::uint64_t kTriangulateSeed = 20260505;
// Relative to the fourth power of the size: what rounding makes of the in-circle determinant.
constexpr double kInCircleTolerance = 1e-12;

std::vector<MeshCase> cases() {
  std::vector<MeshCase> all = knotreel::testing::corpus_cases();
  for (MeshCase& c : knotreel::testing::random_cases(kTriangulateSeed, 50)) all.push_back(std::move(c));
  return all;
}

KnotPair edge_key(KnotIndex a, KnotIndex b) {
  return std::minmax({a, b});
}

std::set<KnotPair> segment_edges(const KnotMesh& mesh) {
  std::set<KnotPair> edges;
  for (const FeatureSegment& s : mesh.segments) {
    for (std::size_t i = 1; i < s.knots.size(); ++i) edges.insert(edge_key(s.knots[i - 1], s.knots[i]));
  }
  return edges;
}

/// Knots opposite each edge.
std::map<KnotPair, std::vector<KnotIndex>> apexes(const KnotMesh& mesh) {
  std::map<KnotPair, std::vector<KnotIndex>> result;
  for (const Face& f : mesh.faces) {
    for (std::size_t i = 0; i < 3; ++i) result[edge_key(f[i], f[(i + 1) % 3])].push_back(f[(i + 2) % 3]);
  }
  return result;
}

/// Positive if d lies inside the circle through a, b, c (in positive order), relative to the size.
double circle_value(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  const Vec2 p = a - d;
  const Vec2 q = b - d;
  const Vec2 r = c - d;
  const double size = std::max({norm(p), norm(q), norm(r)});
  return (dot(p, p) * cross(q, r) + dot(q, q) * cross(r, p) + dot(r, r) * cross(p, q)) / std::pow(size, 4);
}

/// In-circle values of all edges that the triangulation was free to flip.
std::vector<double> delaunay_values(const KnotMesh& mesh) {
  const std::set<KnotPair> constrained = segment_edges(mesh);
  std::vector<double> values;
  for (const auto& [edge, apex] : apexes(mesh)) {
    if (apex.size() != 2 || constrained.contains(edge)) continue;
    const auto at = [&](KnotIndex k) { return mesh.knots[k].position; };
    Vec2 a = at(edge.first);
    Vec2 b = at(edge.second);
    if (signed_area(a, b, at(apex[0])) < 0) std::swap(a, b);
    values.push_back(circle_value(a, b, at(apex[0]), at(apex[1])));
  }
  return values;
}

void expect_refused(KnotMesh mesh, const char* message) {
  try {
    triangulate(mesh);
    ADD_FAILURE() << "accepted, but: " << message;
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kInvalidArgument);
    EXPECT_NE(std::string(e.what()).find(message), std::string::npos) << e.what();
  }
}

TEST(Triangulate, ConstraintsAreEdges) {
  for (const MeshCase& c : cases()) {
    const auto edges = apexes(c.mesh);
    for (const KnotPair& e : segment_edges(c.mesh)) {
      const auto it = edges.find(e);
      ASSERT_NE(it, edges.end()) << c.to_text();
      EXPECT_EQ(it->second.size(), 2u);
    }
  }
}

TEST(Triangulate, EveryOtherEdgeIsDelaunay) {
  for (const MeshCase& c : cases()) {
    for (const double v : delaunay_values(c.mesh)) EXPECT_LE(v, kInCircleTolerance) << c.to_text();
  }
}

TEST(Triangulate, FacesCoverTheDomainOnce) {
  for (const MeshCase& c : cases()) {
    double area = 0;
    for (const auto& [i, j, k] : c.mesh.faces) {
      area += signed_area(c.mesh.knots[i].position, c.mesh.knots[j].position, c.mesh.knots[k].position);
    }
    EXPECT_NEAR(area, c.mesh.width * c.mesh.height, 1e-9 * c.mesh.width * c.mesh.height) << c.to_text();
  }
}

TEST(Triangulate, EqualInputGivesEqualFaces) {
  for (const MeshCase& c : cases()) {
    KnotMesh again = c.mesh;
    triangulate(again);
    EXPECT_EQ(again.faces, c.mesh.faces) << c.to_text();
  }
}

TEST(Triangulate, TheOrderOfTheKnotsDoesNotMatterInGeneralPosition) {
  std::mt19937_64 random(kTriangulateSeed);
  int compared = 0;
  for (const MeshCase& c : cases()) {
    const std::vector<double> values = delaunay_values(c.mesh);
    if (std::any_of(values.begin(), values.end(), [](double v) { return std::abs(v) < 1e-9; })) continue;
    ++compared;
    std::vector<KnotIndex> new_index(c.mesh.knots.size());
    std::iota(new_index.begin(), new_index.end(), 0u);
    std::shuffle(new_index.begin(), new_index.end(), random);
    KnotMesh permuted = c.mesh;
    for (KnotIndex k = 0; k < new_index.size(); ++k) permuted.knots[new_index[k]] = c.mesh.knots[k];
    for (FeatureSegment& s : permuted.segments) {
      for (KnotIndex& k : s.knots) k = new_index[k];
    }
    std::shuffle(permuted.segments.begin(), permuted.segments.end(), random);
    triangulate(permuted);
    std::vector<Face> expected = c.mesh.faces;
    for (Face& f : expected) {
      for (KnotIndex& k : f) k = new_index[k];
    }
    EXPECT_EQ(canonical(permuted.faces), canonical(expected)) << c.to_text();
  }
  EXPECT_GT(compared, 60);
}

TEST(Triangulate, RefusesSegmentsThatCross) {
  MeshBuilder b(100, 80);
  b.segment(b.vertex(20, 20), b.vertex(80, 60), 1);
  b.segment(b.vertex(20, 60), b.vertex(80, 21), 2);
  expect_refused(b.mesh(), "cross");
}

TEST(Triangulate, RefusesSegmentsThroughOtherKnots) {
  MeshBuilder b(100, 80);
  b.free(50, 40);
  b.segment(b.vertex(20, 40), b.vertex(80, 40), 2);
  expect_refused(b.mesh(), "does not follow edges");
}

TEST(Triangulate, RefusesKnotsThatCoincide) {
  MeshBuilder b(100, 80);
  b.free(30, 40);
  b.free(30, 40);
  expect_refused(b.mesh(), "coincide");
}

TEST(Triangulate, RefusesPositionsThatAreNotFinite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()}) {
    MeshBuilder x(100, 80);
    x.free(bad, 40);
    expect_refused(x.mesh(), "no finite position");
    MeshBuilder y(100, 80);
    y.free(40, bad);
    expect_refused(y.mesh(), "no finite position");
  }
}

TEST(Triangulate, RefusesKnotsOutsideTheDomain) {
  MeshBuilder b(100, 80);
  b.free(101, 40);
  expect_refused(b.mesh(), "cannot triangulate: ");
}

TEST(Triangulate, RefusesSegmentsThatNameNoKnots) {
  MeshBuilder b(100, 80);
  b.segment(b.vertex(20, 40), b.vertex(80, 40), 2);
  KnotMesh out_of_range = b.mesh();
  out_of_range.segments[0].knots[1] = static_cast<KnotIndex>(out_of_range.knots.size());
  expect_refused(out_of_range, "a knot that does not exist");
  KnotMesh repeated = b.mesh();
  repeated.segments[0].knots[1] = repeated.segments[0].knots[0];
  expect_refused(repeated, "same knot twice");
}

TEST(Triangulate, RefusesNothingAtAll) {
  expect_refused({}, "fewer than 4 knots");
  KnotMesh no_size = make_domain(100, 80);
  no_size.width = 0;
  expect_refused(no_size, "no usable size");
}

TEST(Domain, HasFourVerticesInPositiveOrder) {
  const KnotMesh mesh = make_domain(100, 80);
  ASSERT_EQ(mesh.knots.size(), 4u);
  for (KnotIndex k = 0; k < 4; ++k) {
    EXPECT_EQ(mesh.knots[k].kind, KnotKind::kVertex);
    EXPECT_EQ(mesh.knots[k].id, KnotId{k});
    EXPECT_GT(signed_area(mesh.knots[k].position, mesh.knots[(k + 1) % 4].position,
                          mesh.knots[(k + 2) % 4].position),
              0);
  }
  EXPECT_TRUE(mesh.faces.empty());
}

}  // namespace
}  // namespace knotreel::mesh
