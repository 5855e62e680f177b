// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/measures.h"

#include <gtest/gtest.h>

#include "knotreel/base/error.h"
#include "motion/scenes.h"
#include "support/pictures.h"

namespace knotreel::motion {
namespace {

using image::Image;
using testing::constant_flow;
using testing::moved_texture;
using testing::Texture;

Image plus(Image image, float offset) {
  for (float& sample : image.samples) sample += offset;
  return image;
}

TEST(FlickerMeter, IsZeroBeforeTheSecondFrame) {
  FlickerMeter meter;
  EXPECT_EQ(meter.flicker(), 0);
  meter.add(test::random_picture(8, 8, 3, 1), test::random_picture(8, 8, 3, 2));
  EXPECT_EQ(meter.flicker(), 0);
  EXPECT_EQ(meter.warped_flicker(), 0);
  EXPECT_TRUE(meter.per_frame().empty());
}

TEST(FlickerMeter, AnErrorThatStaysDoesNotFlicker) {
  FlickerMeter meter;
  const Flow flow = constant_flow(20, 10, {});
  for (unsigned t = 0; t < 5; ++t) {
    const Image reference = test::random_8bit_picture(20, 10, 3, t);
    meter.add(reference, plus(reference, 16), &flow);
  }
  EXPECT_EQ(meter.flicker(), 0);
  EXPECT_EQ(meter.warped_flicker(), 0);
}

TEST(FlickerMeter, AnErrorThatAlternatesFlickersByTwiceItsSize) {
  FlickerMeter meter;
  const Flow flow = constant_flow(20, 10, {});
  for (unsigned t = 0; t < 6; ++t) {
    const Image reference = test::random_8bit_picture(20, 10, 3, t);
    meter.add(reference, plus(reference, t % 2 == 0 ? 3.0F : -3.0F), &flow);
  }
  EXPECT_EQ(meter.flicker(), 6);
  EXPECT_EQ(meter.warped_flicker(), 6);
  EXPECT_EQ(meter.per_frame(), std::vector<double>(5, 6.0));
}

TEST(FlickerMeter, ColoursCountByTheirAlpha) {
  for (const float alpha : {0.0F, 51.0F}) {
    FlickerMeter meter;
    const Flow flow = constant_flow(20, 10, {});
    for (unsigned t = 0; t < 4; ++t) {
      Image reference = test::random_8bit_picture(20, 10, 4, t);
      for (std::size_t i = 3; i < reference.samples.size(); i += 4) reference.samples[i] = alpha;
      Image result = reference;
      for (std::size_t i = 0; i < result.samples.size(); ++i) {
        if (i % 4 != 3) result.samples[i] += t % 2 == 0 ? 30.0F : -30.0F;
      }
      meter.add(reference, result, &flow);
    }
    const double expected = 60 * 0.75 * static_cast<double>(alpha) / 255;  // of the four channels
    EXPECT_NEAR(meter.flicker(), expected, 1e-4);
    EXPECT_NEAR(meter.warped_flicker(), expected, 1e-4);
  }
}

TEST(FlickerMeter, FramesCountEqually) {
  FlickerMeter meter;
  const Image reference = test::random_8bit_picture(9, 9, 1, 1);
  for (const float error : {0.0F, 4.0F, 4.0F, 2.0F}) meter.add(reference, plus(reference, error));
  EXPECT_EQ(meter.per_frame(), (std::vector<double>{4, 0, 2}));
  EXPECT_EQ(meter.flicker(), 2);
}

TEST(FlickerMeter, AnErrorThatMovesWithTheContentFlickersOnlyInPlace) {
  const Texture errors(7);
  const Vec2 step{3, -2};
  const Flow flow = constant_flow(96, 64, step);
  FlickerMeter meter;
  for (int t = 0; t < 4; ++t) {
    const Vec2 d = double(t) * step;
    const Image reference = moved_texture(96, 64, d);
    Image result = reference;
    const Image error = testing::draw(96, 64, [&](Vec2 p) { return 0.2 * errors(p - d); });
    for (std::size_t i = 0; i < result.samples.size(); ++i) result.samples[i] += error.samples[i];
    meter.add(reference, result, &flow);
  }
  EXPECT_GT(meter.flicker(), 3);
  EXPECT_LT(meter.warped_flicker(), 0.01);
}

TEST(FlickerMeter, IsTheFormulaAlongTheFlow) {
  const Image i0 = test::random_picture(6, 5, 3, 1);
  const Image i1 = test::random_picture(6, 5, 3, 2);
  const Image r0 = test::random_picture(6, 5, 3, 3);
  const Image r1 = test::random_picture(6, 5, 3, 4);
  const Flow flow = constant_flow(6, 5, {2, 1});
  FlickerMeter meter;
  meter.add(i0, r0);
  meter.add(i1, r1, &flow);
  double sum = 0;
  for (int y = 0; y < 4; ++y) {
    for (int x = 0; x < 4; ++x) {
      for (int c = 0; c < 3; ++c) {
        sum += std::abs(double{r1.at(x + 2, y + 1, c)} - double{r0.at(x, y, c)} -
                        (double{i1.at(x + 2, y + 1, c)} - double{i0.at(x, y, c)}));
      }
    }
  }
  EXPECT_NEAR(meter.warped_flicker(), sum / 48, 1e-4);
}

TEST(FlickerMeter, PixelsThatAreNotConsistentDoNotCount) {
  const Image black = image::make_image(4, 1, 1);
  Image result = black;
  result.samples = {8, 80, 0, 4};
  const Flow flow = constant_flow(4, 1, {});
  const std::vector<std::uint8_t> mask{1, 0, 1, 1};
  FlickerMeter meter;
  meter.add(black, black);
  meter.add(black, result, &flow, &mask);
  EXPECT_EQ(meter.flicker(), 23);
  EXPECT_EQ(meter.warped_flicker(), 4);
}

TEST(FlickerMeter, FramesWithoutFlowHaveNoWarpedFigure) {
  const Image black = image::make_image(4, 4, 1);
  const Flow flow = constant_flow(4, 4, {});
  FlickerMeter meter;
  meter.add(black, black);
  meter.add(black, plus(black, 5));
  meter.add(black, plus(black, 7), &flow);
  ASSERT_EQ(meter.warped_per_frame().size(), 2U);
  EXPECT_TRUE(std::isnan(meter.warped_per_frame()[0]));
  EXPECT_EQ(meter.warped_flicker(), 2);
  EXPECT_EQ(meter.flicker(), 3.5);
}

TEST(FlickerMeter, RefusesFramesThatDoNotFit) {
  FlickerMeter meter;
  const Image grey = image::make_image(4, 4, 1);
  EXPECT_THROW(meter.add(grey, image::make_image(4, 4, 3)), Error);
  EXPECT_THROW(meter.add(grey, image::make_image(4, 5, 1)), Error);
  meter.add(grey, grey);
  const Image larger = image::make_image(5, 4, 1);
  EXPECT_THROW(meter.add(larger, larger), Error);
  const Flow flow = constant_flow(5, 4, {});
  EXPECT_THROW(meter.add(grey, grey, &flow), Error);
  meter.add(grey, grey);
  EXPECT_EQ(meter.per_frame().size(), 1U);
}

}  // namespace
}  // namespace knotreel::motion
