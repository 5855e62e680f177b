// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "knotreel/knots/link_choice.h"
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
