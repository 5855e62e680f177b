// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/idle_knots.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/mesh_cases.h"

namespace knotreel::knots {
namespace {

using mesh::EditableMesh;
using mesh::KnotKind;

/// Flat, but for a texture below the middle.
image::Image half_flat(int width, int height) {
  image::Image picture = image::make_image(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x)
      picture.at(x, y, 0) =
          2 * y < height ? 100.0F : 100 + 80 * std::sin(0.9F * float(x)) * std::sin(0.7F * float(y));
  }
  return picture;
}

std::size_t count(const EditableMesh& mesh, KnotKind kind) {
  std::size_t result = 0;
  for (mesh::KnotIndex k = 0; k < mesh.knot_slots(); ++k)
    result += mesh.is_knot(k) && mesh.knot(k).kind == kind ? 1 : 0;
  return result;
}

/// Knots on the border come where the picture asks for them, and would pile up if they never went.
TEST(IdleKnots, AreThoseWhereThePictureIsFlatOnTheBorderToo) {
  std::size_t removed_from_border = 0;
  for (const auto& c : knotreel::testing::random_cases(29, 10)) {
    SCOPED_TRACE(c.to_text());
    EditableMesh mesh(c.mesh);
    const std::size_t border = count(mesh, KnotKind::kBorder);
    const std::size_t features = count(mesh, KnotKind::kVertex) + count(mesh, KnotKind::kSegment);
    const std::size_t knots = mesh.knot_count();
    const Target target(half_flat(int(mesh.width()), int(mesh.height())), {});
    const std::size_t removed = remove_idle_knots(mesh, target, {}, {}, knots / 5);
    EXPECT_EQ(mesh.knot_count(), knots - removed);
    EXPECT_EQ(count(mesh, KnotKind::kVertex) + count(mesh, KnotKind::kSegment), features);
    removed_from_border += border - count(mesh, KnotKind::kBorder);
    EXPECT_FALSE(mesh::find_defect(mesh.to_mesh()));
  }
  EXPECT_GT(removed_from_border, 5u);
}

/// Each that goes makes room for one that is worth it, and there are no more than asked for.
TEST(IdleKnots, GoOnlyForFacesThatAreMuchWorse) {
  std::size_t any = 0;
  for (const auto& c : knotreel::testing::random_cases(30, 10)) {
    SCOPED_TRACE(c.to_text());
    const Target target(half_flat(int(c.mesh.width), int(c.mesh.height)), {});
    const auto removed = [&](const std::vector<double>& errors, double share) {
      EditableMesh mesh(c.mesh);
      return remove_idle_knots(mesh, target, errors, {.ratio = 10, .share = share});
    };
    EXPECT_EQ(removed({}, 1), 0u);
    EXPECT_EQ(removed(std::vector<double>(50, 0.0), 1), 0u);
    EXPECT_LE(removed({1e12, 1e12}, 1), 2u);
    const std::vector<double> bad(1000, 1e12);
    EXPECT_LE(double(removed(bad, 0.1)), 0.1 * double(c.mesh.knots.size()));
    EXPECT_LE(removed(bad, 0.1), removed(bad, 1));
    any += removed(bad, 0.1);
  }
  EXPECT_GT(any, 0u);
}

double longest_edge(const EditableMesh& mesh) {
  double longest = 0;
  for (mesh::FaceIndex f = 0; f < mesh.face_slots(); ++f) {
    if (!mesh.is_face(f)) continue;
    const auto v = mesh.triangle(f);
    for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, norm(v[(i + 1) % 3] - v[i]));
  }
  return longest;
}

/// All of the ground is idle, but without its knots faces would reach across it.
TEST(IdleKnots, StayWhereEdgesWouldBeLongWithoutThem) {
  int needed = 0;
  for (const auto& c : knotreel::testing::random_cases(31, 10)) {
    SCOPED_TRACE(c.to_text());
    const Target target(half_flat(int(c.mesh.width), int(c.mesh.height)), {});
    EditableMesh mesh(c.mesh);
    const double longest = longest_edge(mesh);
    const std::size_t all = mesh.knot_count();
    remove_idle_knots(mesh, target, {}, {.longest_edge = longest}, all);
    EXPECT_LE(longest_edge(mesh), longest);
    EditableMesh other(c.mesh);
    remove_idle_knots(other, target, {}, {}, all);
    if (longest_edge(other) > longest) ++needed;
  }
  EXPECT_GT(needed, 0);
}

}  // namespace
}  // namespace knotreel::knots
