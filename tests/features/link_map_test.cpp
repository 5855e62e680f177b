// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/link_map.h"

#include <gtest/gtest.h>

#include "features/join.h"
#include "features/prune.h"
#include "features/walk.h"
#include "support/pictures.h"

namespace knotreel::features {
namespace {

std::vector<int> path(const LinkMap& map, std::initializer_list<std::pair<int, int>> pixels) {
  std::vector<int> result;
  for (const auto& [x, y] : pixels) result.push_back(map.index(x, y));
  return result;
}

/// A row of pixels from one column to another.
std::vector<int> row(const LinkMap& map, int y, int from, int to) {
  std::vector<int> result;
  for (int x = from; x <= to; ++x) result.push_back(map.index(x, y));
  return result;
}

TEST(LinkMap, LinksGoBothWays) {
  LinkMap map(5, 5);
  const int centre = map.index(2, 2);
  EXPECT_EQ(map.x(centre), 2);
  EXPECT_EQ(map.y(centre), 2);
  for (int d = 0; d < 8; ++d) {
    const int other = map.neighbour(centre, d);
    EXPECT_EQ(direction_between(map, centre, other), d);
    map.link(centre, other);
    EXPECT_TRUE(map.linked(centre, d) && map.linked(other, d ^ 4));
    EXPECT_EQ(map.degree(centre), d + 1);
  }
  for (int d = 0; d < 8; ++d) map.unlink(centre, map.neighbour(centre, d));
  EXPECT_FALSE(map.drawn(centre) || map.crowded(centre));
}

TEST(LinkMap, NeighboursOnDifferentChainsAreUnsound) {
  LinkMap map(20, 10);
  map.link_all(row(map, 3, 2, 12));
  map.link_all(row(map, 5, 2, 12));
  EXPECT_TRUE(map.sound(map.index(7, 3)));
  map.link_all(row(map, 4, 15, 18));
  EXPECT_TRUE(map.sound(map.index(12, 3)));
  map.link_all(row(map, 6, 12, 16));
  EXPECT_FALSE(map.sound(map.index(12, 5)));
}

TEST(LinkMap, ArmsMayTouchWithinTwoStepsOfTheirNode) {
  LinkMap map(20, 20);
  map.link_all(row(map, 5, 2, 12));
  map.link_all(path(map, {{7, 5}, {7, 6}, {7, 7}, {7, 8}}));
  for (int i = 0; i < map.size(); ++i) EXPECT_TRUE(!map.drawn(i) || map.sound(i));
  LinkMap along(20, 20);
  along.link_all(row(along, 5, 2, 12));
  along.link_all(path(along, {{7, 5}, {8, 6}, {9, 6}, {10, 6}, {11, 7}}));
  EXPECT_FALSE(along.sound(along.index(10, 6))) << "three steps away, beside the other arm";
}

TEST(LinkMap, DiagonalStepsMustNotCross) {
  // Near a node, or else they would be unsound as neighbours already.
  LinkMap map(20, 20);
  map.link_all(path(map, {{3, 4}, {4, 4}, {5, 5}, {6, 6}, {7, 7}}));
  map.link_all(path(map, {{5, 5}, {6, 5}, {5, 6}, {4, 7}}));
  EXPECT_FALSE(map.sound(map.index(5, 5)));
}

TEST(Join, ATipIsJoinedToWhatIsAhead) {
  for (int gap = 1; gap <= 3; ++gap) {
    LinkMap map(40, 30);
    std::vector<int> wall;
    for (int y = 5; y < 25; ++y) wall.push_back(map.index(30, y));
    map.link_all(wall);
    map.link_all(row(map, 15, 5, 29 - gap));
    EXPECT_TRUE(join_tip(map, map.index(29 - gap, 15), Join::kGaps)) << gap;
    EXPECT_EQ(map.degree(map.index(30, 15)), 3) << gap;
  }
}

TEST(Join, ATipIsNotJoinedToWhatIsAsideOrFar) {
  LinkMap map(40, 30);
  map.link_all(row(map, 15, 5, 20));
  map.link_all(row(map, 18, 5, 35));
  EXPECT_FALSE(join_tip(map, map.index(20, 15), Join::kGaps)) << "a parallel line";
  LinkMap far(40, 30);
  far.link_all(row(far, 15, 5, 20));
  far.link_all(path(far, {{26, 13}, {26, 14}, {26, 15}, {26, 16}, {26, 17}}));
  EXPECT_FALSE(join_tip(far, far.index(20, 15), Join::kGaps));
}

TEST(Join, TwoTipsBecomeOneChain) {
  LinkMap map(40, 30);
  map.link_all(row(map, 15, 5, 15));
  map.link_all(row(map, 15, 18, 30));
  EXPECT_TRUE(join_tip(map, map.index(15, 15), Join::kGaps));
  EXPECT_EQ(stretch_from(map, map.index(5, 15), 0).pixels.size(), 26U);
}

TEST(Join, JunctionsKeepTheirDistance) {
  LinkMap map(40, 40);
  map.link_all(row(map, 10, 5, 35));
  std::vector<int> above;
  for (int y = 0; y <= 10; ++y) above.push_back(map.index(20, y));
  map.link_all(above);
  std::vector<int> below;
  for (int y = 12; y < 30; ++y) below.push_back(map.index(22, y));
  map.link_all(below);
  join_tip(map, map.index(22, 12), Join::kGaps);
  EXPECT_EQ(map.degree(map.index(22, 10)), 2) << "two steps from the junction";
  for (int i = 0; i < map.size(); ++i) EXPECT_TRUE(!map.drawn(i) || map.sound(i));
}

TEST(Join, ContoursCloseAndLoseTheirOverlap) {
  // Once around a rectangle, with an end that overlaps the start by three pixels, two rows aside.
  LinkMap map(40, 40);
  std::vector<int> loop = row(map, 10, 10, 30);
  for (int y = 11; y <= 30; ++y) loop.push_back(map.index(30, y));
  for (int x = 29; x >= 8; --x) loop.push_back(map.index(x, 30));
  for (int y = 29; y >= 10; --y) loop.push_back(map.index(8, y));
  map.link_all(loop);
  EXPECT_TRUE(join_tip(map, map.index(8, 10), Join::kGaps));
  for (int i = 0; i < map.size(); ++i) EXPECT_TRUE(!map.drawn(i) || map.degree(i) == 2);
}

TEST(Join, NothingIsJoinedToTheMiddleOfAStub) {
  LinkMap map(40, 30);
  map.link_all(row(map, 15, 5, 20));
  map.link_all(path(map, {{22, 13}, {22, 14}, {22, 15}, {22, 16}, {22, 17}}));
  join_tip(map, map.index(20, 15), Join::kGaps);
  EXPECT_LE(map.degree(map.index(22, 15)), 2);
  for (int i = 0; i < map.size(); ++i) EXPECT_LE(map.degree(i), 2);
}

TEST(Prune, ArmsThatAreLeftBecomeOneCleanChain) {
  LinkMap map(40, 40);
  map.link_all(row(map, 20, 5, 20));
  std::vector<int> column;
  for (int y = 14; y < 38; ++y) column.push_back(map.index(20, y));
  map.link_all(column);
  const image::Image image = image::make_image(40, 40, 1);
  const GradientField field = make_gradient_field(image, {});
  prune(map, Worth{field, 10, 0});
  EXPECT_FALSE(map.drawn(map.index(20, 15))) << "the short arm";
  EXPECT_FALSE(map.drawn(map.index(20, 20))) << "the corner that is not needed any more";
  EXPECT_EQ(stretch_from(map, map.index(5, 20), 0).pixels.size(), 15U + 17U);
  for (int i = 0; i < map.size(); ++i) EXPECT_TRUE(!map.drawn(i) || map.sound(i));
}

TEST(Walk, KeepsToOneEdge) {
  for (unsigned seed = 0; seed < 5; ++seed) {
    const image::Image image = test::random_picture(80, 80, 1, seed);
    const GradientField field = make_gradient_field(image, {});
    LinkMap map(80, 80);
    Walker walker(field, map, 1);
    std::size_t steps = 0;
    std::size_t turned = 0;
    for (int y = 2; y < 78; y += 5) {
      for (int x = 2; x < 78; x += 5) {
        const std::vector<int> pixels = walker.walk(map.index(x, y));
        for (std::size_t i = 1; i < pixels.size(); ++i) {
          const auto gradient = [&](int p) { return field.gradient(map.x(p), map.y(p)); };
          turned += dot(gradient(pixels[i]), gradient(pixels[i - 1])) <= 0 ? 1 : 0;
          ++steps;
        }
      }
    }
    EXPECT_GT(steps, 1000U);
    EXPECT_LT(double(turned), 0.03 * double(steps)) << "but where a corner pixel was left out";
  }
}

TEST(Join, ChainsRunOnToTheSideTheyHeadFor) {
  LinkMap map(40, 40);
  map.link_all(row(map, 10, 10, 36));
  EXPECT_TRUE(extend_to_side(map, map.index(36, 10)));
  EXPECT_TRUE(map.drawn(map.index(39, 10)));
  EXPECT_FALSE(extend_to_side(map, map.index(10, 10))) << "far from it";
  LinkMap along(40, 40);
  along.link_all(row(along, 2, 10, 30));
  EXPECT_FALSE(extend_to_side(along, along.index(30, 2))) << "near, but it does not head there";
  LinkMap corner(40, 40);
  corner.link_all(path(corner, {{8, 8}, {7, 7}, {6, 6}, {5, 5}, {4, 4}, {3, 3}, {2, 2}}));
  EXPECT_TRUE(extend_to_side(corner, corner.index(2, 2)));
  EXPECT_FALSE(corner.drawn(corner.index(0, 0))) << "which of the two sides would that be?";
  EXPECT_EQ(corner.drawn(corner.index(2, 0)) + corner.drawn(corner.index(0, 2)), 1);
}

}  // namespace
}  // namespace knotreel::features
