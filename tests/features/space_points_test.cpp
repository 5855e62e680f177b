#include "knotreel/features/space_points.h"

#include <gtest/gtest.h>

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
