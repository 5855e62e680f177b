#include "track/foresee.h"

#include <gtest/gtest.h>

#include <algorithm>

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
  const auto fresh = insert_foreseen(mesh, target_of(with_both), before, target_of(edge_at(20)), 8, 1.5);
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
  EXPECT_TRUE(insert_foreseen(mesh, same, before, same, 8, 1.5).empty());
  EXPECT_TRUE(insert_foreseen(mesh, target_of(edge_at(60)), before, same, 0, 1.5).empty());
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
  const auto fresh = insert_foreseen(mesh, same, before, same, 1, 1.5);
  ASSERT_EQ(fresh.size(), 1U);
  EXPECT_LT(norm(mesh.position(fresh[0]) - lost), 10);
}

}  // namespace
}  // namespace knotreel::track
