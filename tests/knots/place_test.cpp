// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/place.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "knotreel/knots/optimise.h"
#include "knots/drawings.h"
#include "support/mesh_cases.h"

namespace knotreel::knots {
namespace {

using mesh::EditableMesh;
using mesh::KnotIndex;
using mesh::KnotKind;

constexpr std::uint64_t kPlaceSeed = 20261125;

Target target_for(const mesh::KnotMesh& mesh, int channels = 3) {
  return Target(testing::disc(static_cast<int>(mesh.width), static_cast<int>(mesh.height), channels), {});
}

// Of a smooth picture: along a hard edge the error can grow again when Delaunay edges come to lie across it.
TEST(InsertKnots, MoreKnotsLeaveLessError) {
  for (const auto& c : knotreel::testing::corpus_cases()) {
    SCOPED_TRACE(c.to_text());
    const Target target(testing::waves(static_cast<int>(c.mesh.width), static_cast<int>(c.mesh.height), 3),
                        {});
    EditableMesh mesh(c.mesh);
    double before = linear_energy(mesh, target);
    for (const std::size_t more : {15U, 30U, 60U}) {
      insert_knots(mesh, target, {.max_knots = c.mesh.knots.size() + more});
      const double after = linear_energy(mesh, target);
      EXPECT_LT(after, before);
      before = after;
      const auto defect = find_defect(mesh.to_mesh());
      EXPECT_FALSE(defect) << *defect;
    }
  }
}

TEST(InsertKnots, KnotsAlongAnEdgeTakeMostOfTheErrorAway) {
  for (const auto& c : knotreel::testing::corpus_cases()) {
    SCOPED_TRACE(c.to_text());
    const Target target = target_for(c.mesh);
    EditableMesh mesh(c.mesh);
    const double before = linear_energy(mesh, target);
    insert_knots(mesh, target, {.max_knots = 150});
    EXPECT_LT(linear_energy(mesh, target), 0.05 * before);
  }
}

TEST(InsertKnots, ThereAreAsManyAsAllowedAndNoMore) {
  const mesh::KnotMesh start = testing::scattered_mesh(100, 80, 25, kPlaceSeed);
  const Target target = target_for(start);
  for (const std::size_t knots :
       {std::size_t{0}, start.knots.size(), start.knots.size() + 1, std::size_t{90}}) {
    EditableMesh mesh(start);
    const std::size_t inserted = insert_knots(mesh, target, {.max_knots = knots});
    EXPECT_EQ(mesh.knot_count(), std::max(knots, start.knots.size()));
    EXPECT_EQ(inserted, mesh.knot_count() - start.knots.size());
  }
}

TEST(InsertKnots, StopWhenTheErrorIsSmallEnough) {
  const mesh::KnotMesh start = testing::scattered_mesh(100, 80, 25, kPlaceSeed);
  const Target target = target_for(start);
  const auto rms = [&](const EditableMesh& mesh) { return std::sqrt(linear_energy(mesh, target) / 8000); };
  EditableMesh mesh(start);
  ASSERT_GT(rms(mesh), 10);
  insert_knots(mesh, target, {.max_knots = 5000, .mec = 6});
  EXPECT_LE(rms(mesh), 6 * (1 + 1e-9));
  EXPECT_GT(rms(mesh), 4) << "far beyond what was asked for";
  EXPECT_EQ(insert_knots(mesh, target, {.max_knots = 5000, .mec = 6}), 0u);
}

TEST(InsertKnots, GoOnWhileAFaceIsWrongThoughThePictureIsNot) {
  const mesh::KnotMesh start = testing::scattered_mesh(100, 80, 25, kPlaceSeed);
  const Target target = target_for(start);
  const auto largest = [&](const EditableMesh& mesh) {
    double error = 0;
    for (mesh::FaceIndex f = 0; f < mesh.face_slots(); ++f)
      if (mesh.is_face(f)) error = std::max(error, target.error(mesh.triangle(f)));
    return error;
  };
  EditableMesh met(start);
  insert_knots(met, target, {.max_knots = 5000, .mec = 1000});
  ASSERT_EQ(met.knot_count(), start.knots.size());
  const double bound = largest(met) / 20;
  insert_knots(met, target, {.max_knots = 5000, .mec = 1000, .face_error = bound});
  EXPECT_LE(largest(met), bound);
  EXPECT_GT(largest(met), bound / 20) << "far beyond what was asked for";
}

TEST(InsertKnots, NothingIsDoneForAPictureOfOneColour) {
  EditableMesh mesh(testing::scattered_mesh(60, 40, 20, kPlaceSeed));
  const Target flat(testing::drawn(60, 40, 3, [](double, double, int) { return 77; }), {});
  EXPECT_EQ(insert_knots(mesh, flat, {.max_knots = 500, .mec = 0.01}), 0u);
}

TEST(InsertKnots, KeepTheirDistances) {
  for (const double distance : {1.0, 3.0}) {
    for (const auto& c : knotreel::testing::corpus_cases()) {
      SCOPED_TRACE("distance " + std::to_string(distance) + '\n' + c.to_text());
      const Target target = target_for(c.mesh);
      EditableMesh mesh(c.mesh);
      const std::size_t first = mesh.knot_slots();
      insert_knots(mesh, target, {.max_knots = 400, .min_distance = distance});
      for (KnotIndex k = static_cast<KnotIndex>(first); k < mesh.knot_slots(); ++k) {
        const Vec2 p = mesh.position(k);
        for (KnotIndex j = 0; j < k; ++j) {
          EXPECT_GE(norm(mesh.position(j) - p), distance * (1 - 1e-9)) << j << ' ' << k;
        }
        if (mesh.knot(k).kind == KnotKind::kFree) {
          EXPECT_GE(testing::distance_to_lines(mesh, p), distance * (1 - 1e-9)) << k;
        }
      }
    }
  }
}

TEST(InsertKnots, TheSameKnotsEveryTime) {
  const mesh::KnotMesh start = testing::scattered_mesh(100, 80, 25, kPlaceSeed);
  const Target target = target_for(start);
  EditableMesh first(start);
  EditableMesh second(start);
  insert_knots(first, target, {.max_knots = 200});
  insert_knots(second, target, {.max_knots = 200});
  const mesh::KnotMesh a = first.to_mesh();
  const mesh::KnotMesh b = second.to_mesh();
  ASSERT_EQ(a.knots.size(), b.knots.size());
  for (std::size_t k = 0; k < a.knots.size(); ++k) EXPECT_EQ(a.knots[k].position, b.knots[k].position);
  EXPECT_EQ(a.faces, b.faces);
}

TEST(InsertKnots, TheFirstKnotGoesToTheCentroidOfTheWorstFace) {
  // One bright dot in an even picture: all errors are around it, in one face.
  mesh::KnotMesh start = testing::scattered_mesh(100, 80, 25, kPlaceSeed);
  image::Image image = image::make_image(100, 80, 3);
  const Vec2 dot{46.5, 31.5};
  image.at(46, 31, 1) = 250;
  const Target target(image, {});
  EditableMesh mesh(start);
  ASSERT_EQ(insert_knots(mesh, target, {.max_knots = start.knots.size() + 1}), 1u);
  const Vec2 p = mesh.position(static_cast<KnotIndex>(start.knots.size()));
  EXPECT_LT(norm(p - dot), 0.5);
}

TEST(InsertKnots, PixelsWithoutWeightDrawNone) {
  const mesh::KnotMesh start = testing::scattered_mesh(100, 80, 25, kPlaceSeed);
  std::vector<float> weights(8000, 1.0F);
  image::Image image = image::make_image(100, 80, 1);
  for (int y = 20; y < 40; ++y) {
    for (int x = 20; x < 40; ++x) {
      image.at(x, y, 0) = static_cast<float>((x * y) % 250);
      weights[std::size_t(y) * 100 + std::size_t(x)] = 0;
    }
  }
  image.at(70, 60, 0) = 200;
  EditableMesh mesh(start);
  insert_knots(mesh, Target(image, weights), {.max_knots = start.knots.size() + 1});
  EXPECT_LT(norm(mesh.position(static_cast<KnotIndex>(start.knots.size())) - Vec2{70.5, 60.5}), 0.5);
}

TEST(InsertNear, GoesWhereItIsWanted) {
  EditableMesh mesh(testing::scattered_mesh(100, 80, 25, kPlaceSeed));
  for (mesh::FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    const auto t = mesh.triangle(f);
    if (signed_area(t[0], t[1], t[2]) < 50) continue;
    const Vec2 wanted = (1.0 / 3) * (t[0] + t[1] + t[2]);
    const auto k = insert_near(mesh, f, wanted, 1);
    ASSERT_TRUE(k);
    if (mesh.knot(*k).kind == KnotKind::kFree) {
      EXPECT_EQ(mesh.position(*k), wanted);
    }
    break;
  }
}

TEST(InsertNear, GoesOntoAFeatureThatIsCloseIfItHasRoom) {
  knotreel::testing::MeshBuilder b(100, 80);
  const KnotIndex from = b.vertex(20, 40);
  const KnotIndex to = b.vertex(80, 40);
  b.segment(from, to, 1);
  const mesh::KnotMesh start = b.triangulated();
  const KnotIndex inside = start.segments[0].knots[1];
  EditableMesh mesh(start);
  const auto k = insert_near(mesh, mesh.edge_between(from, inside).face, {35, 40.5}, 1);
  ASSERT_TRUE(k);
  EXPECT_EQ(mesh.knot(*k).kind, KnotKind::kSegment);
  EXPECT_NEAR(norm(mesh.position(*k) - Vec2{35, 40}), 0, 1e-9);
  EXPECT_FALSE(insert_near(mesh, mesh.edge_between(from, *k).face, {30, 40.5}, 10)) << "no room";
  EXPECT_EQ(mesh.knot_count(), start.knots.size() + 1);
}

}  // namespace
}  // namespace knotreel::knots
