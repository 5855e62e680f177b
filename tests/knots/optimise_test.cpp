// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/optimise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "knotreel/base/parallel.h"
#include "knotreel/knots/place.h"
#include "knots/drawings.h"
#include "support/mesh_cases.h"

namespace knotreel::knots {
namespace {

using mesh::EditableMesh;
using mesh::FaceIndex;
using mesh::KnotIndex;
using mesh::KnotKind;

constexpr std::uint64_t kOptimiseSeed = 20261126;

std::vector<KnotIndex> all_knots(const EditableMesh& mesh) {
  std::vector<KnotIndex> knots;
  for (KnotIndex k = 0; k < mesh.knot_slots(); ++k) {
    if (mesh.is_knot(k)) knots.push_back(k);
  }
  return knots;
}

std::vector<FaceIndex> all_faces(const EditableMesh& mesh) {
  std::vector<FaceIndex> faces;
  for (FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    if (mesh.is_face(f)) faces.push_back(f);
  }
  return faces;
}

/// Fixed edges by their two knots, without the knots that the tests do not insert.
std::set<std::pair<KnotIndex, KnotIndex>> fixed_edges(const EditableMesh& mesh) {
  std::set<std::pair<KnotIndex, KnotIndex>> edges;
  for (const FaceIndex f : all_faces(mesh)) {
    for (int i = 0; i < 3; ++i) {
      if (!mesh.is_fixed({f, i})) continue;
      edges.insert(
          std::minmax({mesh.face(f)[std::size_t((i + 1) % 3)], mesh.face(f)[std::size_t((i + 2) % 3)]}));
    }
  }
  return edges;
}

/// A mesh with features, with knots where the picture wants them.
struct Case {
  std::string text;
  Target target;
  EditableMesh mesh;
};

std::vector<Case> cases(double min_distance = 1) {
  std::vector<Case> result;
  auto meshes = knotreel::testing::corpus_cases();
  for (auto& r : knotreel::testing::random_cases(kOptimiseSeed, 10)) meshes.push_back(std::move(r));
  for (const auto& c : meshes) {
    Case made{c.to_text(),
              Target(testing::disc(static_cast<int>(c.mesh.width), static_cast<int>(c.mesh.height), 3), {}),
              EditableMesh(c.mesh)};
    insert_knots(made.mesh, made.target,
                 {.max_knots = c.mesh.knots.size() + 60, .min_distance = min_distance});
    result.push_back(std::move(made));
  }
  return result;
}

TEST(LinearEnergy, IsTheSumOverTheFaces) {
  EditableMesh mesh(testing::scattered_mesh(100, 80, 20, kOptimiseSeed));
  const Target target(testing::disc(100, 80, 2), {});
  double sum = 0;
  for (const FaceIndex f : all_faces(mesh)) sum += target.error(mesh.triangle(f));
  EXPECT_DOUBLE_EQ(linear_energy(mesh, target), sum);
}

// Pixels enter and leave the faces one by one, so differences need a step of some pixels, over which the
// energy bends: a tenth of the largest gradient is what is left between the two.
TEST(EnergyGradient, AgreesWithDifferencesOfTheEnergy) {
  constexpr double kTolerance = 0.1;
  constexpr double kStep = 2;
  const mesh::KnotMesh start = testing::scattered_mesh(400, 320, 90, kOptimiseSeed);
  const Target target(testing::waves(400, 320, 3), {});
  EditableMesh mesh(start);
  double largest = 0;
  for (const KnotIndex k : all_knots(mesh))
    largest = std::max(largest, norm(energy_gradient(mesh, target, k)));
  for (const KnotIndex k : all_knots(mesh)) {
    if (mesh.knot(k).kind == KnotKind::kVertex) continue;
    const Vec2 at = mesh.position(k);
    const Vec2 gradient = energy_gradient(mesh, target, k);
    const auto difference = [&](Vec2 direction) {
      double sum = 0;
      for (const double sign : {1.0, -1.0}) {
        EXPECT_TRUE(mesh.move(k, at + (sign * kStep) * direction));
        sum += sign * linear_energy(mesh, target);
      }
      EXPECT_TRUE(mesh.move(k, at));
      return sum / (2 * kStep);
    };
    Vec2 expected{difference({1, 0}), difference({0, 1})};
    Vec2 found = gradient;
    if (mesh.knot(k).kind == KnotKind::kBorder) {
      // Across the side it cannot move.
      if (at.x == 0 || at.x == 400) expected.x = found.x = 0;
      if (at.y == 0 || at.y == 320) expected.y = found.y = 0;
    }
    EXPECT_LT(norm(found - expected), kTolerance * largest) << "knot " << k;
    if (norm(expected) > 0.3 * largest) {
      EXPECT_GT(dot(found, expected), 0.95 * norm(found) * norm(expected)) << "knot " << k;
    }
  }
}

TEST(EnergyGradient, AgreesAlongSegmentsToo) {
  knotreel::testing::MeshBuilder b(400, 320);
  const KnotIndex from = b.vertex(60, 70);
  const KnotIndex to = b.vertex(350, 260);
  b.segment(from, to, 1);
  b.free(120, 240);
  b.free(290, 80);
  const mesh::KnotMesh start = b.triangulated();
  const KnotIndex k = start.segments[0].knots[1];
  const Target target(testing::waves(400, 320, 1), {});
  EditableMesh mesh(start);
  const Vec2 at = mesh.position(k);
  const Vec2 along = (1 / norm(Vec2{290, 190})) * Vec2{290, 190};
  const double found = dot(energy_gradient(mesh, target, k), along);
  double expected = 0;
  for (const double sign : {1.0, -1.0}) {
    ASSERT_TRUE(mesh.move(k, at + (2 * sign) * along));
    expected += sign * linear_energy(mesh, target) / 4;
  }
  EXPECT_NEAR(found, expected, 0.05 * std::abs(expected));
}

TEST(IndependentKnots, NoTwoOfAClassAreNeighbours) {
  for (Case& c : cases()) {
    SCOPED_TRACE(c.text);
    const std::vector<KnotIndex> knots = all_knots(c.mesh);
    std::set<KnotIndex> listed;
    std::vector<FaceIndex> ring;
    for (const auto& members : independent_knots(c.mesh, knots)) {
      const std::set<KnotIndex> in_class(members.begin(), members.end());
      EXPECT_EQ(in_class.size(), members.size());
      for (const KnotIndex k : members) {
        EXPECT_TRUE(listed.insert(k).second);
        c.mesh.faces_around(k, ring);
        for (const FaceIndex f : ring) {
          for (const KnotIndex j : c.mesh.face(f)) EXPECT_TRUE(j == k || !in_class.contains(j));
        }
      }
    }
    for (const KnotIndex k : knots) {
      EXPECT_EQ(listed.contains(k), c.mesh.knot(k).kind != KnotKind::kVertex) << k;
    }
  }
}

TEST(OptimisePositions, NeverRaisesTheEnergyAndKeepsTheMeshSound) {
  double gained = 0;
  for (Case& c : cases()) {
    SCOPED_TRACE(c.text);
    const auto edges = fixed_edges(c.mesh);
    const double first = linear_energy(c.mesh, c.target);
    double before = first;
    for (int sweep = 0; sweep < 5; ++sweep) {
      optimise(c.mesh, c.target, {.rounds = 1, .steps = 1, .connectivity = false});
      const double after = linear_energy(c.mesh, c.target);
      EXPECT_LE(after, before * (1 + 1e-9));
      before = after;
      testing::expect_sound(c.mesh);
    }
    gained = std::max(gained, 1 - before / first);
    EXPECT_EQ(fixed_edges(c.mesh), edges);
  }
  EXPECT_GT(gained, 0.1);
}

TEST(Optimise, DoesNotDependOnTheNumberOfThreads) {
  const Target target(testing::disc(200, 160, 3), {});
  std::vector<Vec2> positions[2];
  for (int i = 0; i < 2; ++i) {
    const ThreadCap cap(i + 1);
    EditableMesh mesh(testing::scattered_mesh(200, 160, 9, kOptimiseSeed));
    optimise(mesh, target, {.rounds = 2, .steps = 2});
    for (const KnotIndex k : all_knots(mesh)) positions[i].push_back(mesh.position(k));
  }
  EXPECT_EQ(positions[0], positions[1]);
}

double smallest_angle(const std::array<Vec2, 3>& t) {
  double least = 180;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec2 a = t[(i + 1) % 3] - t[i];
    const Vec2 b = t[(i + 2) % 3] - t[i];
    least = std::min(least, std::atan2(cross(a, b), dot(a, b)) * 180 / 3.141592653589793);
  }
  return least;
}

TEST(OptimiseConnectivity, NeverRaisesTheEnergyAndKeepsFixedEdges) {
  std::size_t flips = 0;
  for (Case& c : cases()) {
    SCOPED_TRACE(c.text);
    const OptimiseOptions options;
    const auto edges = fixed_edges(c.mesh);
    const auto faces = all_faces(c.mesh);
    double thinnest = options.least_angle;
    for (const FaceIndex f : faces) thinnest = std::min(thinnest, smallest_angle(c.mesh.triangle(f)));
    const double before = linear_energy(c.mesh, c.target);
    flips += optimise_connectivity(c.mesh, c.target, options, faces);
    EXPECT_LE(linear_energy(c.mesh, c.target), before);
    EXPECT_EQ(fixed_edges(c.mesh), edges);
    testing::expect_sound(c.mesh);
    for (const FaceIndex f : all_faces(c.mesh))
      EXPECT_GE(smallest_angle(c.mesh.triangle(f)), thinnest * (1 - 1e-9));
    // No single flip is left that would help.
    for (const FaceIndex f : all_faces(c.mesh)) {
      for (int i = 0; i < 3; ++i) {
        if (!c.mesh.can_flip({f, i})) continue;
        const FaceIndex other = c.mesh.neighbour(f, i);
        const double now = c.target.error(c.mesh.triangle(f)) + c.target.error(c.mesh.triangle(other));
        EditableMesh copy = c.mesh;
        copy.flip({f, i});
        if (smallest_angle(copy.triangle(f)) < options.least_angle + 1e-9) continue;
        if (smallest_angle(copy.triangle(other)) < options.least_angle + 1e-9) continue;
        EXPECT_GE(c.target.error(copy.triangle(f)) + c.target.error(copy.triangle(other)), now * (1 - 1e-6));
      }
    }
  }
  EXPECT_GT(flips, 100u);
}

TEST(RemoveSlivers, LeavesNoFreeKnotNearALine) {
  std::size_t removed = 0;
  // Knots that were allowed closer than they are now.
  for (Case& c : cases(0.2)) {
    SCOPED_TRACE(c.text);
    const OptimiseOptions options;
    const std::size_t before = c.mesh.knot_count();
    const std::size_t gone = remove_slivers(c.mesh, c.target, options);
    EXPECT_EQ(c.mesh.knot_count(), before - gone);
    removed += gone;
    testing::expect_sound(c.mesh);
    for (const KnotIndex k : all_knots(c.mesh)) {
      if (c.mesh.knot(k).kind != KnotKind::kFree) continue;
      EXPECT_GE(testing::distance_to_lines(c.mesh, c.mesh.position(k)), options.min_distance) << "knot " << k;
    }
  }
  EXPECT_GT(removed, 50u);
}

TEST(RemoveSlivers, TakesTheKnotAtTheFlatAngle) {
  mesh::KnotMesh start = testing::scattered_mesh(100, 80, 30, kOptimiseSeed);
  EditableMesh mesh(start);
  // Next to the middle of a plain edge: the face on the far side of the knot is flat.
  for (const FaceIndex f : all_faces(mesh)) {
    if (mesh.is_fixed({f, 0})) continue;
    const auto [p, a, b] = mesh.triangle(f);
    const KnotIndex k = mesh.insert_in_face(f, 0.5 * (a + b) + 0.01 * (p - a));
    const Target flat(testing::drawn(100, 80, 1, [](double, double, int) { return 9; }), {});
    EXPECT_EQ(remove_slivers(mesh, flat, {}), 1u);
    EXPECT_FALSE(mesh.is_knot(k));
    return;
  }
  FAIL();
}

TEST(Optimise, LowersTheEnergyAndTouchesOnlyActiveKnots) {
  for (Case& c : cases()) {
    SCOPED_TRACE(c.text);
    EditableMesh some = c.mesh;
    std::vector<bool> active(some.knot_slots(), false);
    for (std::size_t k = 0; k < active.size(); k += 3) active[k] = true;
    const double before = linear_energy(some, c.target);
    optimise(some, c.target, {}, active);
    for (const KnotIndex k : all_knots(some)) {
      if (active[k]) continue;
      EXPECT_EQ(some.position(k), c.mesh.position(k));
    }
    EXPECT_LE(linear_energy(some, c.target), before * (1 + 1e-9));
    testing::expect_sound(some);
    EditableMesh all = c.mesh;
    optimise(all, c.target, {});
    EXPECT_LT(linear_energy(all, c.target), before);
    testing::expect_sound(all);
    EditableMesh none = c.mesh;
    optimise(none, c.target, {.positions = false, .connectivity = false});
    EXPECT_EQ(none.to_mesh().faces, c.mesh.to_mesh().faces);
  }
}

TEST(Optimise, KeepsTheDistancesOfKnotsItMoves) {
  std::size_t moved = 0;
  for (Case& c : cases()) {
    SCOPED_TRACE(c.text);
    EditableMesh mesh = c.mesh;
    const OptimiseOptions options{.connectivity = false};
    optimise(mesh, c.target, options);
    std::vector<FaceIndex> ring;
    for (const KnotIndex k : all_knots(mesh)) {
      // Knots on features that stay where they are may be put on their line anew.
      if (norm(mesh.position(k) - c.mesh.position(k)) < 1e-9) continue;
      ++moved;
      mesh.faces_around(k, ring);
      for (const FaceIndex f : ring) {
        for (const KnotIndex j : mesh.face(f)) {
          if (j == k) continue;
          EXPECT_GE(norm(mesh.position(j) - mesh.position(k)), options.min_distance * (1 - 1e-9));
        }
      }
    }
  }
  EXPECT_GT(moved, 100U);
}

}  // namespace
}  // namespace knotreel::knots
