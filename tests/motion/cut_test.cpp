// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/cut.h"

#include <gtest/gtest.h>

#include "knotreel/base/error.h"
#include "knotreel/motion/warp.h"
#include "motion/scenes.h"
#include "support/pictures.h"

namespace knotreel::motion {
namespace {

using image::Image;
using testing::draw;
using testing::in_other_light;
using testing::moved_texture;
using testing::with_noise;

constexpr int kCutWidth = 192;
constexpr int kCutHeight = 128;

double change(const Image& before, const Image& now) {
  const Luma from = luma_of(before);
  const Luma to = luma_of(now);
  return unlikeness(from, warp(to, find_flow(from, to)));
}

Image scene(Vec2 d = {}, unsigned seed = 1) {
  return moved_texture(kCutWidth, kCutHeight, d, seed);
}

TEST(IsCut, FiresOnAnotherScene) {
  for (unsigned seed = 2; seed < 12; ++seed) {
    const double unlike = change(scene(), scene({}, seed));
    EXPECT_TRUE(is_cut(unlike)) << seed << ": " << unlike;
  }
}

TEST(IsCut, FiresOnAPictureOutOfBlackAndBack) {
  const Image black = draw(kCutWidth, kCutHeight, [](Vec2) { return 0.0; });
  EXPECT_TRUE(is_cut(change(black, scene())));
  EXPECT_TRUE(is_cut(change(scene(), black)));
}

TEST(IsCut, FiresInNoise) {
  EXPECT_TRUE(is_cut(change(with_noise(scene(), 12, 1), with_noise(scene({}, 2), 12, 2))));
}

TEST(IsCut, HoldsWhereNothingChanges) {
  EXPECT_LT(change(scene(), scene()), 0.001);
}

TEST(IsCut, HoldsInAPan) {
  for (const Vec2 d : {Vec2{2, 0}, Vec2{8, 3}, Vec2{-12, 0}}) {
    const double unlike = change(scene(), scene(d));
    EXPECT_FALSE(is_cut(unlike)) << d.x << ": " << unlike;
  }
}

TEST(IsCut, HoldsInAFade) {
  double light = 1;
  while (light > 0.05) {
    const double next = light - 0.05;
    EXPECT_FALSE(is_cut(change(in_other_light(scene(), light, 0), in_other_light(scene({1, 0}), next, 0))));
    EXPECT_FALSE(is_cut(change(in_other_light(scene(), next, 0), in_other_light(scene({1, 0}), light, 0))));
    light = next;
  }
}

TEST(IsCut, HoldsInADissolve) {
  const auto mixed = [](double share) {
    Image a = scene();
    const Image b = scene({}, 2);
    for (std::size_t i = 0; i < a.samples.size(); ++i) {
      a.samples[i] += float(share) * (b.samples[i] - a.samples[i]);
    }
    return a;
  };
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(is_cut(change(mixed(0.1 * i), mixed(0.1 * (i + 1)))));
}

TEST(IsCut, HoldsInAFlash) {
  EXPECT_FALSE(is_cut(change(scene(), in_other_light(scene({1, 1}), 1.0, 60))));
  EXPECT_FALSE(is_cut(change(in_other_light(scene(), 1.0, 60), scene({1, 1}))));
  EXPECT_FALSE(is_cut(change(scene(), in_other_light(scene(), 1.3, 20))));
}

TEST(IsCut, HoldsInNoise) {
  EXPECT_FALSE(is_cut(change(with_noise(scene(), 20, 1), with_noise(scene(), 20, 2))));
  const Image dark = draw(kCutWidth, kCutHeight, [](Vec2) { return 25.0; });
  EXPECT_FALSE(is_cut(change(with_noise(dark, 6, 1), with_noise(dark, 6, 2))));
}

TEST(IsCut, FollowsTheThreshold) {
  EXPECT_TRUE(is_cut(0.5, {.threshold = 0.5}));
  EXPECT_FALSE(is_cut(0.5, {.threshold = 0.51}));
}

TEST(IsCut, NothingIsOneAtAThresholdOfOne) {
  EXPECT_TRUE(is_cut(1, {.threshold = 0.999}));
  EXPECT_FALSE(is_cut(1, {.threshold = 1}));
}

TEST(Unlikeness, AnySizeWillDo) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 50}, {7, 5}, {33, 31}}) {
    const Image picture = moved_texture(width, height, {});
    EXPECT_FALSE(is_cut(change(picture, picture)));
  }
}

TEST(Unlikeness, RefusesWhatDoesNotFit) {
  const Luma picture{8, 8, std::vector<std::uint8_t>(64)};
  EXPECT_THROW(unlikeness(picture, {8, 9, std::vector<std::uint8_t>(72)}), Error);
  EXPECT_THROW(unlikeness({}, {}), Error);
}

}  // namespace
}  // namespace knotreel::motion
