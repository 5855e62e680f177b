#include "knotreel/motion/cut.h"

#include <gtest/gtest.h>

#include "knotreel/base/error.h"
#include "motion/scenes.h"
#include "support/pictures.h"

namespace knotreel::motion {
namespace {

using image::Image;
using testing::draw;
using testing::in_other_light;
using testing::moved_texture;
using testing::with_noise;

constexpr int kWidth = 192;
constexpr int kHeight = 128;

CutMeasure change(const Image& before, const Image& now) {
  const FlowPair pair = find_flow_pair(luma_of(before), luma_of(now));
  return measure_change(before, now, pair.forward, pair.consistent);
}

Image scene(Vec2 d = {}, unsigned seed = 1) {
  return moved_texture(kWidth, kHeight, d, seed);
}

TEST(IsCut, FiresOnAnotherScene) {
  for (unsigned seed = 2; seed < 12; ++seed) {
    const CutMeasure measure = change(scene(), scene({}, seed));
    EXPECT_TRUE(is_cut(measure)) << seed << ": " << measure.unlike;
    EXPECT_GT(measure.residual, 10);
    EXPECT_GT(measure.unmatched, 0.3);
  }
}

TEST(IsCut, FiresOnAPictureOutOfBlackAndBack) {
  const Image black = draw(kWidth, kHeight, [](Vec2) { return 0.0; });
  EXPECT_TRUE(is_cut(change(black, scene())));
  EXPECT_TRUE(is_cut(change(scene(), black)));
}

TEST(IsCut, FiresInNoise) {
  EXPECT_TRUE(is_cut(change(with_noise(scene(), 12, 1), with_noise(scene({}, 2), 12, 2))));
}

TEST(IsCut, HoldsWhereNothingChanges) {
  const CutMeasure measure = change(scene(), scene());
  EXPECT_FALSE(is_cut(measure));
  EXPECT_NEAR(measure.histogram, 0, 1e-12);
  EXPECT_LT(measure.residual, 0.5);
  EXPECT_EQ(measure.unmatched, 0);
  EXPECT_LT(measure.unlike, 0.001);
}

TEST(IsCut, HoldsInAPan) {
  for (const Vec2 d : {Vec2{2, 0}, Vec2{8, 3}, Vec2{-12, 0}}) {
    const CutMeasure measure = change(scene(), scene(d));
    EXPECT_FALSE(is_cut(measure)) << d.x << ": " << measure.unlike;
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
  const Image dark = draw(kWidth, kHeight, [](Vec2) { return 25.0; });
  EXPECT_FALSE(is_cut(change(with_noise(dark, 6, 1), with_noise(dark, 6, 2))));
}

TEST(IsCut, FollowsTheThreshold) {
  CutMeasure measure;
  measure.unlike = 0.5;
  EXPECT_TRUE(is_cut(measure, {.threshold = 0.5}));
  EXPECT_FALSE(is_cut(measure, {.threshold = 0.51}));
}

TEST(MeasureChange, HistogramsOfOtherColoursHaveNothingInCommon) {
  Image red = image::make_image(kWidth, kHeight, 3);
  Image cyan = red;
  for (std::size_t i = 0; i < red.samples.size(); i += 3) {
    red.samples[i] = 255;
    cyan.samples[i + 1] = cyan.samples[i + 2] = 255;
  }
  EXPECT_NEAR(change(red, cyan).histogram, 1, 1e-6);
  EXPECT_NEAR(change(red, red).histogram, 0, 1e-12);
}

TEST(MeasureChange, CachedLumaChangesNothing) {
  const Image a = test::random_picture(64, 48, 3, 1);
  const Image b = test::random_picture(64, 48, 3, 2);
  const FlowPair pair = find_flow_pair(luma_of(a), luma_of(b));
  const CutMeasure plain = measure_change(a, b, pair.forward, pair.consistent);
  const CutMeasure cached = measure_change(a, b, luma_of(a), luma_of(b), pair.forward, pair.consistent);
  EXPECT_EQ(plain.histogram, cached.histogram);
  EXPECT_EQ(plain.residual, cached.residual);
  EXPECT_EQ(plain.unmatched, cached.unmatched);
  EXPECT_EQ(plain.unlike, cached.unlike);
}

TEST(MeasureChange, AnySizeWillDo) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 50}, {7, 5}, {33, 31}}) {
    const Image picture = moved_texture(width, height, {});
    EXPECT_FALSE(is_cut(change(picture, picture)));
  }
}

TEST(MeasureChange, RefusesWhatDoesNotFit) {
  const Image picture = image::make_image(8, 8, 1);
  const Flow flow = testing::constant_flow(8, 8, {});
  EXPECT_THROW(measure_change(picture, image::make_image(8, 9, 1), flow, std::vector<std::uint8_t>(64)),
               Error);
  EXPECT_THROW(measure_change(picture, picture, flow, std::vector<std::uint8_t>(63)), Error);
}

}  // namespace
}  // namespace knotreel::motion
