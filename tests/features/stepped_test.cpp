// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/stepped.h"

#include <gtest/gtest.h>

#include <random>

#include "features/drawings.h"
#include "knotreel/features/detect.h"
#include "knotreel/features/fair.h"

namespace knotreel::features {
namespace {

constexpr int kDiscSide = 80;
constexpr Vec2 kDiscCentre{40.3, 39.4};
constexpr unsigned kSeed = 11;

/// Each pixel has the colour of its centre.
image::Image without_antialiasing(double radius, int levels) {
  image::Image image = image::make_image(kDiscSide, kDiscSide, 1);
  for (int y = 0; y < kDiscSide; ++y) {
    for (int x = 0; x < kDiscSide; ++x) {
      const bool inside = norm(Vec2{x + 0.5, y + 0.5} - kDiscCentre) < radius;
      image.at(x, y, 0) = float(100 + (inside ? levels : 0));
    }
  }
  return image;
}

/// Mean distance of the points of all chains from a circle.
double off_circle(const FeatureChains& chains, double radius) {
  double sum = 0;
  std::size_t points = 0;
  for (const Chain& chain : chains.chains) {
    for (const ChainPoint& p : chain.points) sum += std::abs(norm(p.position - kDiscCentre) - radius);
    points += chain.points.size();
  }
  return sum / double(points);
}

TEST(Stepped, EdgesWithoutColoursInBetween) {
  for (const double radius : {7.0, 15.0, 31.0}) {
    const FeatureChains hard = detect_features(without_antialiasing(radius, 120));
    ASSERT_FALSE(hard.chains.empty());
    for (const Chain& chain : hard.chains) EXPECT_TRUE(chain.stepped) << radius;
    const FeatureChains soft =
        detect_features(testing::disc(kDiscSide, kDiscCentre.x, kDiscCentre.y, radius, 220, 100));
    ASSERT_FALSE(soft.chains.empty());
    for (const Chain& chain : soft.chains) EXPECT_FALSE(chain.stepped) << radius;
  }
}

TEST(Stepped, NotWithNoise) {
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::normal_distribution<float> noise(0, 8);
  image::Image picture = without_antialiasing(25, 120);
  for (float& sample : picture.samples) sample += noise(random);
  for (const Chain& chain : detect_features(picture).chains) EXPECT_FALSE(chain.stepped);
}

TEST(Stepped, FairingTakesTheStepsOutOfThem) {
  for (const double radius : {9.0, 15.0, 31.0}) {
    FeatureChains hard = detect_features(without_antialiasing(radius, 120));
    const double before = off_circle(hard, radius);
    FeatureChains as_others = hard;
    for (Chain& chain : as_others.chains) chain.stepped = false;
    fair_chains(as_others);
    fair_chains(hard);
    EXPECT_GT(off_circle(as_others, radius), 0.75 * before) << radius;
    EXPECT_LT(off_circle(hard, radius), 0.6 * before) << radius;
  }
}

}  // namespace
}  // namespace knotreel::features
