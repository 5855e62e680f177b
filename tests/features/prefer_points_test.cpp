// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/prefer_points.h"

#include <gtest/gtest.h>

#include "features/drawings.h"

namespace knotreel::features {
namespace {

using testing::chain_through;

std::vector<int> preferred(const FeatureChains& chains) {
  std::vector<int> columns;
  for (const Chain& c : chains.chains) {
    for (const ChainPoint& p : c.points)
      if (p.preferred) columns.push_back(p.x);
  }
  return columns;
}

FeatureChains row() {
  FeatureChains chains;
  chains.width = 20;
  chains.height = 10;
  chains.node_count = 2;
  chains.chains.push_back(
      chain_through({{2, 4}, {3, 4}, {4, 4}, {5, 4}, {6, 4}, {7, 4}, {8, 4}, {9, 4}, {10, 4}}, 0, 1));
  return chains;
}

TEST(PreferPoints, TheNearestPointOfEachPlaceIsMarked) {
  FeatureChains chains = row();
  prefer_points(chains, std::vector<Vec2>{{3.4, 5.5}, {8.6, 3}, {8.7, 4.5}}, 2);
  EXPECT_EQ(preferred(chains), (std::vector<int>{3, 8}));
}

TEST(PreferPoints, PlacesFarFromAllChainsOrOutsideMarkNothing) {
  FeatureChains chains = row();
  prefer_points(chains, std::vector<Vec2>{{5, 7}, {14, 4.5}, {-40, 4.5}, {5, 400}, {NAN, 4}}, 2);
  EXPECT_TRUE(preferred(chains).empty());
}

TEST(PreferPoints, MarksDoNotStay) {
  FeatureChains chains = row();
  prefer_points(chains, std::vector<Vec2>{{5.5, 4.5}}, 2);
  prefer_points(chains, std::vector<Vec2>{{7.5, 4.5}}, 2);
  EXPECT_EQ(preferred(chains), (std::vector<int>{7}));
}

TEST(PreferPoints, WhatCountsIsWhereTheCurveIs) {
  FeatureChains chains = row();
  chains.chains[0].points[3].move_to({5.5, 7});  // a corner beyond its pixel
  prefer_points(chains, std::vector<Vec2>{{5.5, 7.2}}, 2);
  EXPECT_EQ(preferred(chains), (std::vector<int>{5}));
}

}  // namespace
}  // namespace knotreel::features
