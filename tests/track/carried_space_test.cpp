// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>

#include "knotreel/knots/link_choice.h"
#include "knotreel/mesh/edge_lengths.h"
#include "knotreel/mesh/editable_mesh.h"
#include "knotreel/spline/basis.h"
#include "support/mesh_cases.h"
#include "support/pictures.h"
#include "track/carried_geometry.h"
#include "track/carried_links.h"

namespace knotreel::track {
namespace {

TEST(LinkMemory, TheSameMeshGetsTheSameLinks) {
  for (const auto& c : testing::random_cases(21, 20)) {
    const knots::Target first(test::random_picture(int(c.mesh.width), int(c.mesh.height), 1, 1), {});
    const knots::Target other(test::random_picture(int(c.mesh.width), int(c.mesh.height), 1, 2), {});
    const spline::SplineSpace space(c.mesh, 2, knots::picture_links(first));
    const spline::SplineSpace again = LinkMemory(space).space_over(c.mesh, 2, other);
    EXPECT_TRUE(std::ranges::equal(space.link_codes(), again.link_codes())) << c.name;
  }
}

/// The mesh with its free knots somewhere else, up to a share of their shortest edge.
mesh::KnotMesh jittered(mesh::KnotMesh mesh, double share, std::mt19937_64& random) {
  const std::vector<double> shortest = mesh::shortest_edges(mesh);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (std::size_t k = 0; k < shortest.size(); ++k) {
    const Vec2 way{unit(random), unit(random)};
    if (mesh.knots[k].kind == mesh::KnotKind::kFree)
      mesh.knots[k].position = mesh.knots[k].position + share * shortest[k] * way;
  }
  return mesh;
}

TEST(LinkMemory, LinksThatHaveTurnedOverAreChosenAnew) {
  std::mt19937_64 random(5);
  std::size_t sound = 0;
  for (const auto& c : testing::random_cases(24, 60)) {
    const mesh::KnotMesh moved = jittered(c.mesh, 0.3, random);
    if (mesh::find_defect(moved)) continue;
    ++sound;
    const knots::Target target(test::random_picture(int(c.mesh.width), int(c.mesh.height), 1, 3), {});
    const LinkMemory memory(spline::SplineSpace(c.mesh, 3, knots::picture_links(target)));
    const spline::Basis basis(
        std::make_shared<const spline::SplineSpace>(memory.space_over(moved, 3, target)));
    std::vector<spline::BasisValue> values;
    for (const Vec2 u : testing::probe_points(moved, 4, 100)) {
      basis.evaluate(u, values);
      double sum = 0;
      for (const spline::BasisValue& v : values) {
        ASSERT_GE(v.value, -1e-9) << c.name;
        sum += v.value;
      }
      ASSERT_NEAR(sum, 1, 1e-9) << c.name;
    }
  }
  EXPECT_GT(sound, 5u);
}

TEST(CarriedDisplacement, NewControlPointsAreBetweenThoseAround) {
  const Vec2 all{0.5, -0.25};  // inside; nothing on the sides
  std::size_t fresh = 0;
  for (const auto& c : testing::random_cases(23, 20)) {
    const spline::SplineSpace space(c.mesh, 2);
    std::vector<Vec2> displacement;
    for (const Vec2 site : space.geometry_greville())
      displacement.push_back(mesh::on_side(c.mesh, site) ? Vec2{} : all);
    mesh::EditableMesh more(c.mesh);
    const auto faces = static_cast<mesh::FaceIndex>(c.mesh.faces.size());
    for (mesh::FaceIndex f = 0; f < faces; f += 3) {
      const auto [p, q, r] = more.triangle(f);
      if (signed_area(p, q, r) > 20) more.insert_in_face(f, (1.0 / 3) * (p + q + r));
    }
    const spline::SplineSpace larger(more.to_mesh(), 2);
    fresh += larger.geometry_count() - space.geometry_count();
    const std::vector<Vec2> sites = larger.geometry_greville();
    const std::vector<Vec2> carried = carried_displacement(space, displacement, larger);
    for (std::size_t g = 0; g < sites.size(); ++g) {
      if (mesh::on_side(larger.mesh(), sites[g])) continue;
      EXPECT_NEAR(cross(carried[g], all), 0, 1e-12) << c.name << ' ' << g;
      EXPECT_GE(dot(carried[g], all), 0) << c.name << ' ' << g;
      EXPECT_LE(norm(carried[g]), norm(all) + 1e-12) << c.name << ' ' << g;
    }
  }
  EXPECT_GT(fresh, 100u);
}

TEST(CarriedDisplacement, TheSameSpaceKeepsIt) {
  for (const auto& c : testing::random_cases(22, 20)) {
    const spline::SplineSpace space(c.mesh, 2);
    std::vector<Vec2> displacement = space.geometry_greville();
    const std::vector<Vec2> sites = displacement;
    for (std::size_t g = 0; g < sites.size(); ++g) {
      const bool border =
          sites[g].x <= 0 || sites[g].y <= 0 || sites[g].x >= c.mesh.width || sites[g].y >= c.mesh.height;
      displacement[g] = border ? Vec2{} : Vec2{0.1 * sites[g].y, -0.2 * sites[g].x};
    }
    const std::vector<Vec2> carried = carried_displacement(space, displacement, space);
    EXPECT_EQ(carried, displacement) << c.name;
  }
}

}  // namespace
}  // namespace knotreel::track
