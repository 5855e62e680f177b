// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/refine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "knots/drawings.h"
#include "support/mesh_cases.h"

namespace knotreel::knots {
namespace {

using mesh::EditableMesh;
using mesh::KnotIndex;
using mesh::KnotKind;

constexpr std::uint64_t kRefineSeed = 20261127;
constexpr int kWidth = 100;
constexpr int kHeight = 80;

/// Squared errors of a picture, zero at first.
struct ErrorPicture {
  std::vector<float> squared = std::vector<float>(std::size_t(kWidth) * kHeight, 0.0F);

  void fill(int x, int y, int width, int height, float value) {
    for (int v = y; v < y + height; ++v) {
      for (int u = x; u < x + width; ++u) squared[std::size_t(v) * kWidth + std::size_t(u)] = value;
    }
  }
};

std::vector<KnotIndex> refine(EditableMesh& mesh, const ErrorPicture& errors,
                              const RefineOptions& options = {}, std::span<const Vec2> places = {}) {
  return refine_knots(mesh, errors.squared, places, kWidth, kHeight, options);
}

EditableMesh coarse_mesh() {
  return EditableMesh(testing::scattered_mesh(kWidth, kHeight, 26, kRefineSeed));
}

/// The middle of some large face with room around it.
Vec2 roomy_place(const EditableMesh& mesh, std::size_t which) {
  std::vector<Vec2> places;
  for (mesh::FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    const auto [a, b, c] = mesh.triangle(f);
    const Vec2 centre = (1.0 / 3) * (a + b + c);
    if (signed_area(a, b, c) > 150 && testing::distance_to_lines(mesh, centre) > 10) places.push_back(centre);
  }
  return places.at(which);
}

TEST(RefineKnots, NoErrorNoKnots) {
  EditableMesh mesh = coarse_mesh();
  EXPECT_TRUE(refine(mesh, {}).empty());
  EXPECT_TRUE(refine_knots(mesh, {}, {}, 0, 0, {}).empty());
}

TEST(RefineKnots, KnotsGoWhereTheErrorIs) {
  for (std::size_t which = 0; which < 5; ++which) {
    EditableMesh mesh = coarse_mesh();
    const Vec2 at = roomy_place(mesh, which);
    ErrorPicture errors;
    errors.fill(static_cast<int>(at.x) - 2, static_cast<int>(at.y) - 2, 5, 5, 100);
    const auto knots = refine(mesh, errors, {.max_knots = 1});
    ASSERT_EQ(knots.size(), 1u);
    const Vec2 middle{std::floor(at.x) + 0.5, std::floor(at.y) + 0.5};
    EXPECT_EQ(mesh.position(knots[0]), middle) << "the two-ring of the middle holds all of the error";
    testing::expect_sound(mesh);
  }
}

/// A knot on a feature splits the faces on both sides of it.
TEST(RefineKnots, KnotsGoWhereTheErrorIsBeyondAFeatureThatIsSplit) {
  knotreel::testing::MeshBuilder b(kWidth, kHeight);
  const KnotIndex top = b.vertex(50, 10), bottom = b.vertex(50, 70);
  b.segment(top, bottom, 0);
  b.segment(bottom, b.vertex(20, 75), 1);
  b.free(5, 40);
  b.free(95, 40);
  const mesh::KnotMesh halves = b.triangulated();
  for (const int y : {22, 54}) {
    EditableMesh mesh(halves);
    ErrorPicture errors;
    errors.fill(44, 38, 5, 5, 200);  // beside the feature
    errors.fill(60, y, 5, 5, 100);
    const auto knots = refine(mesh, errors, {.max_knots = 2});
    ASSERT_EQ(knots.size(), 2U);
    EXPECT_EQ(mesh.knot(knots[0]).kind, KnotKind::kSegment);
    EXPECT_EQ(mesh.position(knots[1]), (Vec2{62.5, y + 2.5}));
    testing::expect_sound(mesh);
  }
}

TEST(RefineKnots, SmallClustersAreLeftAlone) {
  const Vec2 at = roomy_place(coarse_mesh(), 0);
  const int x = static_cast<int>(at.x) - 2;
  const int y = static_cast<int>(at.y) - 2;
  EditableMesh mesh = coarse_mesh();
  ErrorPicture small;
  small.fill(x, y, 7, 2, 100);
  EXPECT_TRUE(refine(mesh, small).empty());
  EXPECT_EQ(refine(mesh, small, {.least_cluster = 14}).size(), 1u);
  ErrorPicture enough;
  enough.fill(x, y, 5, 3, 100);
  EditableMesh other = coarse_mesh();
  EXPECT_FALSE(refine(other, enough).empty());
}

TEST(RefineKnots, PixelsTwoApartAreOneClusterThreeApartAreNot) {
  const Vec2 at = roomy_place(coarse_mesh(), 0);
  for (const int gap : {2, 3}) {
    for (const bool upright : {false, true}) {
      EditableMesh mesh = coarse_mesh();
      ErrorPicture errors;
      // Two strokes of two by four pixels.
      const int x = static_cast<int>(at.x) - 3;
      const int y = static_cast<int>(at.y) - 3;
      for (const int i : {0, 1}) {
        const int offset = i * (1 + gap);
        errors.fill(x + (upright ? 0 : offset), y + (upright ? offset : 0), upright ? 4 : 2, upright ? 2 : 4,
                    100);
      }
      EXPECT_EQ(refine(mesh, errors).empty(), gap == 3) << gap;
    }
  }
}

TEST(RefineKnots, TheLargestErrorsComeFirst) {
  EditableMesh mesh = coarse_mesh();
  const Vec2 weak = roomy_place(mesh, 0);
  const Vec2 strong = roomy_place(mesh, 3);
  ASSERT_GT(norm(weak - strong), 15);
  ErrorPicture errors;
  errors.fill(static_cast<int>(weak.x) - 2, static_cast<int>(weak.y) - 2, 5, 5, 60);
  errors.fill(static_cast<int>(strong.x) - 2, static_cast<int>(strong.y) - 2, 5, 5, 100);
  const auto first = refine(mesh, errors, {.max_knots = 1});
  ASSERT_EQ(first.size(), 1u);
  EXPECT_LT(norm(mesh.position(first[0]) - strong), 1);
  EditableMesh other = coarse_mesh();
  EXPECT_LT(norm(other.position(refine(other, errors, {.max_knots = 9}).at(1)) - weak), 1);
}

TEST(RefineKnots, FaintErrorsAreReachedByLoweringTheThreshold) {
  EditableMesh mesh = coarse_mesh();
  const Vec2 weak = roomy_place(mesh, 0);
  const Vec2 strong = roomy_place(mesh, 3);
  ErrorPicture errors;
  errors.fill(static_cast<int>(weak.x) - 2, static_cast<int>(weak.y) - 2, 5, 5, 1);
  errors.fill(static_cast<int>(strong.x) - 2, static_cast<int>(strong.y) - 2, 5, 5, 1000);
  const auto knots = refine(mesh, errors, {.max_knots = 2});
  ASSERT_EQ(knots.size(), 2u);
  EXPECT_LT(norm(mesh.position(knots[1]) - weak), 1);
}

/// A few pixels in a face of their own, beside a cluster in another one, belong to it as soon as the
/// threshold is below them, though it was large without them.
TEST(RefineKnots, ClustersGrowWhileTheThresholdFalls) {
  knotreel::testing::MeshBuilder b(kWidth, kHeight);
  b.segment(b.vertex(50, 0), b.vertex(50, 80), 0);
  const mesh::KnotMesh halves = b.triangulated();
  for (const int gap : {1, 2}) {  // pixels without an error
    EditableMesh mesh(halves);
    ErrorPicture errors;
    errors.fill(44, 38, 5, 5, 1000);      // up to 1 pixel from the feature
    errors.fill(49 + gap, 39, 2, 2, 50);  // beyond it; alone too small
    EXPECT_EQ(refine(mesh, errors, {.max_knots = 9}).size(), gap == 1 ? 2U : 1U) << gap;
  }
  // Too small at first, with all of their edges large enough.
  EditableMesh mesh(halves);
  ErrorPicture errors;
  errors.fill(5, 38, 5, 5, 50);
  errors.fill(6, 39, 3, 3, 1000);
  EXPECT_EQ(refine(mesh, errors, {.max_knots = 9}).size(), 1U);
  errors.fill(5, 38, 5, 5, 0);
  errors.fill(6, 39, 3, 3, 1000);
  EXPECT_TRUE(refine(mesh, errors, {.max_knots = 9}).empty());
}

TEST(RefineKnots, PlacesOfPixelsSayWhereTheyAre) {
  EditableMesh mesh = coarse_mesh();
  const Vec2 at = roomy_place(mesh, 2);
  std::vector<Vec2> places;
  for (int i = 0; i < kWidth * kHeight; ++i) places.push_back({i % kWidth + 0.9, i / kWidth + 0.3});
  ErrorPicture errors;
  errors.fill(static_cast<int>(at.x) - 2, static_cast<int>(at.y) - 2, 5, 5, 100);
  const auto knots = refine(mesh, errors, {.max_knots = 1}, places);
  ASSERT_EQ(knots.size(), 1u);
  EXPECT_NEAR(norm(mesh.position(knots[0]) - (Vec2{std::floor(at.x) + 0.9, std::floor(at.y) + 0.3})), 0,
              1e-12);
}

TEST(RefineKnots, AnyErrorsLeaveTheMeshSound) {
  std::mt19937_64 random(kRefineSeed);
  auto meshes = knotreel::testing::corpus_cases();
  for (auto& r : knotreel::testing::random_cases(kRefineSeed, 20)) meshes.push_back(std::move(r));
  for (const auto& c : meshes) {
    SCOPED_TRACE(c.to_text());
    EditableMesh mesh(c.mesh);
    const int width = static_cast<int>(c.mesh.width);
    const int height = static_cast<int>(c.mesh.height);
    for (int round = 0; round < 3; ++round) {
      std::vector<float> errors(std::size_t(width) * std::size_t(height));
      for (float& e : errors) e = static_cast<float>(random() % 1000);
      const std::size_t before = mesh.knot_count();
      const auto knots = refine_knots(mesh, errors, {}, width, height, {.max_knots = 30});
      EXPECT_LE(knots.size(), 30u);
      EXPECT_GT(knots.size() + static_cast<std::size_t>(round), 0u);
      EXPECT_EQ(mesh.knot_count(), before + knots.size());
      testing::expect_sound(mesh);
      for (const KnotIndex k : knots) mesh.legalise_around(k);
    }
  }
}

class RefineFeatures : public ::testing::Test {
 protected:
  RefineFeatures() {
    knotreel::testing::MeshBuilder b(kWidth, kHeight);
    b.segment(b.vertex(10, 40), b.vertex(70, 40), 1);
    b.segment(b.vertex(20, 10), b.vertex(20, 25), 2);
    start = b.triangulated();
  }
  mesh::KnotMesh start;
};

TEST_F(RefineFeatures, TwoKnotsGoIntoTheIntervalsThatAreWrong) {
  EditableMesh mesh(start);
  const std::vector<CurveError> errors{
      {0, {50, 40}, 2}, {0, {55, 40}, 3}, {0, {15, 40}, 0.5}, {1, {20, 12}, 1}};
  const auto knots = refine_features(mesh, errors, 1, 1);
  EXPECT_EQ(knots.size(), 2u) << "once for each interval, and not at the bound itself";
  const auto& segment = mesh.segments()[0].knots;
  ASSERT_EQ(segment.size(), 5u);
  const double at[] = {10, 40, 50, 60, 70};
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(mesh.position(segment[i]).x, at[i], 1e-9);
  for (const KnotIndex k : knots) EXPECT_EQ(mesh.knot(k).kind, KnotKind::kSegment);
  testing::expect_sound(mesh);
}

TEST_F(RefineFeatures, AllIntervalsAtOnce) {
  EditableMesh mesh(start);
  const std::vector<CurveError> errors{
      {1, {20, 24}, 9}, {0, {69, 40}, 9}, {1, {20, 11}, 9}, {0, {11, 40}, 9}};
  EXPECT_EQ(refine_features(mesh, errors, 1, 1).size(), 8u);
  const double first[] = {10, 20, 30, 40, 50, 60, 70};
  ASSERT_EQ(mesh.segments()[0].knots.size(), 7u);
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_NEAR(mesh.position(mesh.segments()[0].knots[i]).x, first[i], 1e-9);
  EXPECT_EQ(mesh.segments()[1].knots.size(), 8u);
  testing::expect_sound(mesh);
}

TEST_F(RefineFeatures, ShortIntervalsAreLeftAlone) {
  EditableMesh mesh(start);
  const std::vector<CurveError> errors{{1, {20, 24}, 9}};
  EXPECT_TRUE(refine_features(mesh, errors, 1, 1.3).empty()) << "5 pixels are less than four distances";
  EXPECT_EQ(refine_features(mesh, errors, 1, 1.2).size(), 2u);
}

}  // namespace
}  // namespace knotreel::knots
