// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/foresee.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "knotreel/knots/place.h"
#include "support/mesh_cases.h"
#include "track/edge_picture.h"

namespace knotreel::track {
namespace {

/// A grid of knots over the pictures of edge_picture.h.
mesh::KnotMesh grid() {
  knotreel::testing::MeshBuilder builder(96, 64);
  for (int y = 8; y < 64; y += 8) {
    for (int x = 8; x < 96; x += 8) builder.free(x + 0.3 * (y % 3), y);
  }
  return builder.triangulated();
}

knots::Target target_of(image::Image image) {
  return {std::move(image), std::vector<float>{}};
}

TEST(Foresee, KnotsComeWhereTheNewPictureIsHarder) {
  const mesh::KnotMesh before = grid();
  mesh::EditableMesh mesh(before, 1000);
  // The edge at the left stays, another one comes at the right.
  image::Image with_both = edge_at(20);
  const image::Image right = edge_at(70);
  for (std::size_t i = 0; i < with_both.samples.size(); ++i) with_both.samples[i] += 0.5F * right.samples[i];
  const Foresight foresight(mesh, target_of(with_both), FaceErrors(before, target_of(edge_at(20))));
  EXPECT_GT(foresight.loss(), 0.5);
  EXPECT_TRUE(std::ranges::is_sorted(foresight.growths(), std::greater<>()));
  const auto fresh = foresight.insert(mesh, 8, 1.5);
  ASSERT_EQ(fresh.size(), 8U);
  EXPECT_EQ(mesh::find_defect(mesh.to_mesh()), std::nullopt);
  for (const mesh::KnotIndex k : fresh) {
    const Vec2 p = mesh.position(k);
    EXPECT_NEAR(p.x + 0.3 * (p.y - 32), 70, 15) << p.x << ' ' << p.y;  // faces at the border are long
    EXPECT_GE(static_cast<std::uint32_t>(mesh.knot(k).id), 1000U);
  }
}

TEST(Foresee, NothingComesWhereNothingIsNew) {
  const mesh::KnotMesh before = grid();
  mesh::EditableMesh mesh(before);
  const knots::Target same = target_of(edge_at(40));
  const Foresight foresight(mesh, same, FaceErrors(before, same));
  EXPECT_EQ(foresight.loss(), 0);
  EXPECT_TRUE(foresight.growths().empty());
  EXPECT_TRUE(foresight.insert(mesh, 8, 1.5).empty());
  EXPECT_TRUE(Foresight(mesh, target_of(edge_at(60)), FaceErrors(before, same)).insert(mesh, 0, 1.5).empty());
  EXPECT_EQ(mesh.to_mesh().knots.size(), before.knots.size());
}

TEST(Foresee, TheHoleOfALostKnotCountsAsNew) {
  const mesh::KnotMesh before = grid();
  mesh::EditableMesh mesh(before);
  const knots::Target same = target_of(edge_at(48));
  const auto nearest =
      std::min_element(before.knots.begin(), before.knots.end(), [](const auto& a, const auto& b) {
        return norm(a.position - Vec2{48, 32}) < norm(b.position - Vec2{48, 32});
      });
  const Vec2 lost = nearest->position;
  ASSERT_TRUE(mesh.remove(static_cast<mesh::KnotIndex>(nearest - before.knots.begin())));
  const auto fresh = Foresight(mesh, same, FaceErrors(before, same)).insert(mesh, 1, 1.5);
  ASSERT_EQ(fresh.size(), 1U);
  EXPECT_LT(norm(mesh.position(fresh[0]) - lost), 10);
}

bool contains(const std::array<Vec2, 3>& t, Vec2 p) {
  return signed_area(t[0], t[1], p) >= 0 && signed_area(t[1], t[2], p) >= 0 &&
         signed_area(t[2], t[0], p) >= 0;
}

TEST(Foresee, FacesThatAreGoneGetNoKnot) {
  const mesh::KnotMesh before = grid();
  mesh::EditableMesh mesh(before);
  const Foresight foresight(mesh, target_of(edge_at(70)), FaceErrors(before, target_of(edge_at(20))));
  std::vector<mesh::Face> at_first(mesh.face_slots());
  for (mesh::FaceIndex f = 0; f < at_first.size(); ++f) at_first[f] = mesh.face(f);
  std::size_t removed = 0;
  for (mesh::KnotIndex k = 0; k < before.knots.size(); ++k) {
    const mesh::Knot& knot = before.knots[k];
    if (knot.kind == mesh::KnotKind::kFree && knot.position.x > 60) removed += mesh.remove(k) ? 1 : 0;
  }
  ASSERT_GT(removed, 10U);
  std::vector<std::array<Vec2, 3>> left;
  for (mesh::FaceIndex f = 0; f < at_first.size(); ++f) {
    if (mesh.is_face(f) && mesh.face(f) == at_first[f]) left.push_back(mesh.triangle(f));
  }
  const auto fresh = foresight.insert(mesh, 1000, 1.5);
  EXPECT_FALSE(fresh.empty());
  for (const mesh::KnotIndex k : fresh) {
    const Vec2 p = mesh.position(k);
    EXPECT_TRUE(std::ranges::any_of(left, [p](const auto& t) { return contains(t, p); }))
        << p.x << ' ' << p.y;
  }
  EXPECT_EQ(mesh::find_defect(mesh.to_mesh()), std::nullopt);
}

}  // namespace
}  // namespace knotreel::track
