// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/long_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "knots/drawings.h"
#include "support/mesh_cases.h"

namespace knotreel::knots {
namespace {

using mesh::EditableMesh;

constexpr std::size_t kAnyNumber = 100000;

/// Of the edges of faces that have room for a knot.
double longest_with_room(const EditableMesh& mesh) {
  double longest = 0;
  for (mesh::FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    if (!mesh.is_face(f)) continue;
    const auto v = mesh.triangle(f);
    double length = 0;
    for (std::size_t i = 0; i < 3; ++i) length = std::max(length, norm(v[(i + 1) % 3] - v[i]));
    const double height = 2 * signed_area(v[0], v[1], v[2]) / length;
    if (height > length / 4) longest = std::max(longest, length);
  }
  return longest;
}

TEST(SplitLongEdges, LeavesNoneWhereThereIsRoom) {
  for (const double spacing : {20.0, 45.0, 90.0}) {
    SCOPED_TRACE(spacing);
    EditableMesh mesh(testing::scattered_mesh(200, 150, spacing, 5));
    const double longest = longest_with_room(mesh) / 3;
    const std::size_t before = mesh.knot_count();
    const std::size_t inserted = split_long_edges(mesh, longest, kAnyNumber);
    EXPECT_GT(inserted, 0u);
    EXPECT_EQ(mesh.knot_count(), before + inserted);
    EXPECT_LE(longest_with_room(mesh), longest);
    testing::expect_sound(mesh);
    EXPECT_EQ(split_long_edges(mesh, longest, kAnyNumber), 0u);
  }
}

/// Beside features there is not always room, and nothing breaks.
TEST(SplitLongEdges, KeepsMeshesSound) {
  for (const auto& c : knotreel::testing::random_cases(32, 10)) {
    SCOPED_TRACE(c.to_text());
    EditableMesh mesh(c.mesh);
    const std::size_t before = mesh.knot_count();
    const std::size_t inserted = split_long_edges(mesh, 10, kAnyNumber);
    EXPECT_EQ(mesh.knot_count(), before + inserted);
    testing::expect_sound(mesh);
  }
}

/// About as many as there are squares of that side, whatever was there.
TEST(SplitLongEdges, TakesFewKnots) {
  EditableMesh mesh(testing::scattered_mesh(640, 360, 300, 7));
  const std::size_t inserted = split_long_edges(mesh, 64, kAnyNumber);
  EXPECT_LE(inserted, 4u * (640 * 360) / (64 * 64));
}

TEST(SplitLongEdges, TheLongestComeFirstAndThereAreNoMoreThanAllowed) {
  const mesh::KnotMesh start = testing::scattered_mesh(200, 150, 6, 11);
  double before = longest_with_room(EditableMesh(start));
  for (const std::size_t most : {4U, 16U, 64U}) {
    EditableMesh mesh(start);
    EXPECT_EQ(split_long_edges(mesh, 5, most), most);
    EXPECT_LT(longest_with_room(mesh), before);
    before = longest_with_room(mesh);
  }
}

TEST(SplitLongEdges, ShortOnesAreLeftAlone) {
  EditableMesh mesh(testing::scattered_mesh(100, 80, 25, 13));
  EXPECT_EQ(split_long_edges(mesh, 200, kAnyNumber), 0u);
}

}  // namespace
}  // namespace knotreel::knots
