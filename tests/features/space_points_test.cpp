// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/space_points.h"

#include <gtest/gtest.h>

#include <random>

#include "features/drawings.h"

namespace knotreel::features {
namespace {

using testing::chain_through;

FeatureChains with(Chain chain) {
  FeatureChains chains;
  chains.width = 20;
  chains.height = 10;
  chains.node_count = 2;
  chains.chains.push_back(std::move(chain));
  return chains;
}

Chain row_of_pixels() {
  return chain_through({{2, 4}, {3, 4}, {4, 4}, {5, 4}, {6, 4}, {7, 4}, {8, 4}}, 0, 1);
}

/// Least of the steps along the chain, in its direction.
double least_step(const Chain& chain) {
  double least = 1e9;
  for (std::size_t i = 1; i < chain.points.size(); ++i)
    least = std::min(least, chain.points[i].on_curve().x - chain.points[i - 1].on_curve().x);
  return least;
}

TEST(SpacePoints, WhatTurnsBackNextToAnEndIsSpreadOut) {
  Chain chain = row_of_pixels();
  chain.points[0].move_to({3.4, 4.5});  // an end that is nearly where the next point is, or behind it
  chain.points[1].move_to({3.39, 4.52});
  chain.points.back().move_to({7.505, 4.5});
  EXPECT_LT(least_step(chain), 0.01);
  FeatureChains chains = with(chain);
  space_points(chains);
  EXPECT_GT(least_step(chains.chains[0]), 0.3);
  EXPECT_EQ(chains.chains[0].points[0].on_curve(), chain.points[0].on_curve());
  EXPECT_EQ(chains.chains[0].points.back().on_curve(), chain.points.back().on_curve());
}

TEST(SpacePoints, CornersCountLikeEnds) {
  Chain chain = row_of_pixels();
  chain.points[3].corner = true;
  chain.points[3].move_to({4.49, 4.5});
  FeatureChains chains = with(chain);
  space_points(chains);
  EXPECT_GT(least_step(chains.chains[0]), 0.4);
  EXPECT_EQ(chains.chains[0].points[3].on_curve(), (Vec2{4.49, 4.5}));
}

TEST(SpacePoints, OthersStay) {
  Chain chain = row_of_pixels();
  chain.points[3].move_to({5.51, 4.5});  // near each other, but off corners and ends
  chain.points[4].move_to({5.81, 4.5});
  FeatureChains chains = with(chain);
  space_points(chains);
  for (std::size_t i = 0; i < chain.points.size(); ++i)
    EXPECT_EQ(chains.chains[0].points[i].on_curve(), chain.points[i].on_curve()) << i;
}

TEST(SpacePoints, NoPointIsNextToAnother) {
  Chain chain = row_of_pixels();
  chain.points[3].move_to({5.51, 4.5});
  chain.points[4].move_to({5.45, 4.55});  // behind it
  FeatureChains chains = with(chain);
  space_points(chains);
  EXPECT_GT(least_step(chains.chains[0]), 0.4);
  EXPECT_EQ(chains.chains[0].points[3].on_curve(), (Vec2{5.51, 4.5}));
  EXPECT_EQ(chains.chains[0].points[5].on_curve(), chain.points[5].on_curve());
}

TEST(SpacePoints, AnEndMayBeTheNextThatIsFarEnough) {
  Chain chain = row_of_pixels();
  chain.points[4].move_to({7.01, 4.5});  // both next to each other, and far from the end
  chain.points[5].move_to({6.93, 4.62});
  chain.points[6].move_to({9.3, 4.5});
  FeatureChains chains = with(chain);
  space_points(chains);
  EXPECT_GT(least_step(chains.chains[0]), 0.9);
  EXPECT_EQ(chains.chains[0].points[6].on_curve(), (Vec2{9.3, 4.5}));

  chain = row_of_pixels();
  chain.points[5].move_to({8.2, 4.5});  // too near the end for both to lie between it and the one before them
  chain.points[4].move_to({8.15, 4.5});
  chain.points[6].move_to({8.75, 4.5});
  chains = with(chain);
  space_points(chains, 0.5);
  EXPECT_GT(least_step(chains.chains[0]), 0.5);
  EXPECT_EQ(chains.chains[0].points[5].on_curve(), (Vec2{8.2, 4.5}));
}

TEST(SpacePoints, CornersAtOneSpotAreOne) {
  Chain chain = row_of_pixels();
  for (const std::size_t i : {2U, 4U}) chain.points[i].corner = true;
  chain.points[2].move_to({5.5, 4.5});
  chain.points[3].move_to({5.5, 4.5});
  chain.points[4].move_to({5.45, 4.6});
  FeatureChains chains = with(chain);
  space_points(chains);
  EXPECT_GT(least_step(chains.chains[0]), 0.3);
  EXPECT_EQ(chains.chains[0].points[2].on_curve(), (Vec2{5.5, 4.5}));
  EXPECT_TRUE(chains.chains[0].points[2].corner);
  EXPECT_FALSE(chains.chains[0].points[4].corner);
}

TEST(SpacePoints, KeepTheDistanceThatIsAskedFor) {
  Chain chain = row_of_pixels();
  chain.points[3].move_to({5.5, 4.5});
  chain.points[4].move_to({5.83, 4.5});
  for (const double least : {0.25, 0.5, 0.75}) {
    FeatureChains chains = with(chain);
    space_points(chains, least);
    if (least == 0.25) {
      EXPECT_EQ(chains.chains[0].points[4].on_curve(), chain.points[4].on_curve());
    } else {
      EXPECT_GE(least_step(chains.chains[0]), least);
    }
  }
}

/// Vertices of polylines are at the positions, which stay near their pixels where the curve is further away.
TEST(SpacePoints, PositionsKeepTheDistance) {
  Chain chain = row_of_pixels();
  chain.points[6].corner = true;
  chain.points[6].move_to({8.5, 6.84});  // a sharp tip: its position is at 5.5
  chain.points[5].move_to({8.4, 5.4});
  EXPECT_LT(norm(chain.points[6].position - chain.points[5].position), 0.2);
  EXPECT_GT(norm(chain.points[6].on_curve() - chain.points[5].on_curve()), 1);
  FeatureChains chains = with(chain);
  space_points(chains, 0.5);
  const std::vector<ChainPoint>& points = chains.chains[0].points;
  EXPECT_EQ(points[6].on_curve(), chain.points[6].on_curve());
  EXPECT_EQ(points[6].position, chain.points[6].position);
  EXPECT_NEAR(points[5].position.y, 0.5 * (points[4].position.y + points[6].position.y), 1e-9);
  EXPECT_NEAR(points[5].on_curve().y, 0.5 * (points[4].on_curve().y + points[6].on_curve().y), 1e-9);
  for (std::size_t i = 1; i < points.size(); ++i) {
    EXPECT_GE(norm(points[i].position - points[i - 1].position), 0.5) << i;
    EXPECT_GE(norm(points[i].on_curve() - points[i - 1].on_curve()), 0.5) << i;
  }
}

TEST(SpacePoints, OfRandomChainsNoneIsNearTheNextUnlessBothStay) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> off(-1, 1);
    Chain chain = chain_through({{2, 4},
                                 {3, 4},
                                 {4, 4},
                                 {5, 4},
                                 {6, 4},
                                 {7, 4},
                                 {8, 4},
                                 {9, 4},
                                 {10, 4},
                                 {11, 4},
                                 {12, 4},
                                 {13, 4},
                                 {14, 4}},
                                0, 1);
    for (ChainPoint& p : chain.points) {
      p.move_to(p.position + Vec2{off(random), 0.3 * off(random)});
      p.corner = random() % 6 == 0;
    }
    const double least = 0.5;
    FeatureChains chains = with(chain);
    space_points(chains, least);
    const std::vector<ChainPoint>& points = chains.chains[0].points;
    const auto stays = [&](std::size_t i) { return i == 0 || i + 1 == points.size() || points[i].corner; };
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      if (stays(i)) {
        EXPECT_EQ(points[i].on_curve(), chain.points[i].on_curve());
      }
      // With one that stays within reach on either side there may be no room.
      bool has_room = !stays(i) || !stays(i + 1);
      for (std::size_t j = i < 2 ? 0 : i - 2; j < std::min(points.size(), i + 4); ++j) has_room &= !stays(j);
      if (has_room) {
        EXPECT_GE(norm(points[i + 1].on_curve() - points[i].on_curve()), 0.999 * least) << i;
        EXPECT_GE(norm(points[i + 1].position - points[i].position), 0.999 * least) << i;
      }
    }
  }
}

TEST(SpacePoints, ChainsThatAreShortOrClosedAreSound) {
  FeatureChains chains = with(chain_through({{2, 4}, {3, 4}}, 0, 1));
  chains.chains[0].points[1].move_to({2.6, 4.5});
  space_points(chains);
  EXPECT_EQ(chains.chains[0].points[1].on_curve(), (Vec2{2.6, 4.5}));

  FeatureChains loop = with(testing::square_chain(2, 2, 6));
  Chain& ring = loop.chains[0];
  ring.points[0].corner = true;
  ring.points[0].move_to(ring.points.back().position);
  space_points(loop);
  for (std::size_t i = 0; i < ring.points.size(); ++i) {
    const Vec2 next = ring.points[(i + 1) % ring.points.size()].on_curve();
    EXPECT_GT(norm(next - ring.points[i].on_curve()), 0.3) << i;
  }
  for (ChainPoint& p : ring.points) p.move_to({4.5, 4.5});  // all crowded: nothing to go by
  space_points(loop);
}

}  // namespace
}  // namespace knotreel::features
