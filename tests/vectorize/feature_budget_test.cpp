// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/feature_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "knotreel/features/chains.h"
#include "knotreel/image/image.h"

namespace knotreel::vectorize {
namespace {

using features::Chain;
using features::FeatureChains;

constexpr int kSide = 100;

/// A checkerboard of fields of two pixels: every chain has the same contrast at any distance, so none is
/// weak.
image::Image fields_of(float contrast) {
  image::Image picture;
  picture.width = picture.height = kSide;
  picture.channels = 1;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) picture.samples.push_back((x / 2 + y / 2) % 2 == 0 ? 0 : contrast);
  }
  return picture;
}

Chain straight(int y, int points) {
  Chain chain;
  for (int i = 0; i < points; ++i) chain.points.push_back({10 + i, y, {10.5 + i, y + 0.5}});
  return chain;
}

/// Turns by half a right angle every few pixels, to and fro.
Chain winding(int y, int points) {
  Chain chain = straight(y, points);
  for (int i = 0; i < points; ++i) {
    const int step = i % 16 < 8 ? i % 8 : 8 - i % 8;
    chain.points[static_cast<std::size_t>(i)].y = y + step;
    chain.points[static_cast<std::size_t>(i)].position.y = y + step + 0.5;
  }
  return chain;
}

FeatureChains chains_of(std::vector<Chain> list) {
  return {kSide, kSide, std::move(list), 6};
}

TEST(FeatureBudget, WhatFitsStays) {
  FeatureChains chains = chains_of({straight(20, 60), winding(60, 60)});
  const DroppedFeatures dropped = keep_within_budget(fields_of(200), 60, 1000, {}, chains);
  EXPECT_EQ(chains.chains.size(), 2U);
  EXPECT_EQ(dropped.points, 0);
  EXPECT_EQ(dropped.mean_contrast(), 0);
}

TEST(FeatureBudget, WindingChainsAreDropped) {
  FeatureChains chains = chains_of({winding(50, 30), straight(20, 30), winding(70, 30)});
  drop_winding(0.2, chains);
  EXPECT_EQ(chains.chains.size(), 3U) << "a right angle every eight pixels is at most 0.2";
  drop_winding(0.05, chains);
  ASSERT_EQ(chains.chains.size(), 1U);
  EXPECT_EQ(chains.chains[0].points.back().y, 20);
  drop_winding(1e-9, chains);
  EXPECT_EQ(chains.chains.size(), 1U) << "a straight one does not turn";
}

TEST(FeatureBudget, OfTheSameContrastTheStraightOneStays) {
  const Chain simple = straight(20, 30);
  const std::vector<std::vector<Chain>> orders{{simple, winding(35, 30), winding(50, 30), winding(70, 30)},
                                               {winding(35, 30), winding(50, 30), simple, winding(70, 30)},
                                               {winding(35, 30), winding(50, 30), winding(70, 30), simple}};
  for (const std::vector<Chain>& order : orders) {
    FeatureChains chains = chains_of(order);
    // Three tenths of the pixels may stay.
    const DroppedFeatures dropped = keep_within_budget(fields_of(200), 100, 99, {.any = 1}, chains);
    ASSERT_EQ(chains.chains.size(), 1U);
    EXPECT_EQ(chains.chains[0].points.back().y, 20);
    EXPECT_TRUE(dropped.strong);
    EXPECT_EQ(dropped.points, 90);
  }
}

TEST(FeatureBudget, WeakOnesGoAboveTheirShare) {
  // Contrast of 100 levels, all of it within a pixel, or half of it beyond.
  const auto picture = [](bool soft) {
    image::Image p = image::make_image(kSide, kSide, 1);
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x)
        p.at(x, y, 0) = soft ? float(std::clamp(20 * (y - 17), 0, 120)) : y < 20 ? 0 : 100;
    }
    return p;
  };
  DroppedFeatures dropped;
  const auto left = [&](bool soft, double weak) {
    FeatureChains chains = chains_of({straight(20, 30)});
    dropped.add(keep_within_budget(picture(soft), 150, 1000, {.weak = weak}, chains));
    return chains.chains.size();
  };
  EXPECT_EQ(left(true, 0.1), 0U);
  EXPECT_EQ(left(true, 0.2), 1U);
  EXPECT_EQ(left(false, 0.1), 1U);
  EXPECT_FALSE(dropped.strong);
  EXPECT_EQ(dropped.points, 30);
  EXPECT_EQ(dropped.mean_contrast(), 40) << "of its pixels and those beside them";
  EXPECT_EQ(left(true, 0.1), 0U);
  EXPECT_EQ(dropped.points, 60);
  EXPECT_EQ(dropped.mean_contrast(), 40);
}

}  // namespace
}  // namespace knotreel::vectorize
