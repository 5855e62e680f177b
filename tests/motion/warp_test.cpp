// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/warp.h"

#include <gtest/gtest.h>

#include "knotreel/base/error.h"
#include "motion/scenes.h"
#include "support/pictures.h"

namespace knotreel::motion {
namespace {

using testing::constant_flow;

TEST(Warp, NoMotionGivesThePictureItself) {
  const image::Image picture = test::random_picture(13, 9, 4, 1);
  EXPECT_EQ(warp(picture, constant_flow(13, 9, {})).samples, picture.samples);
}

TEST(Warp, WholePixelsFetchOtherPixels) {
  const image::Image picture = test::random_picture(13, 9, 3, 1);
  const image::Image warped = warp(picture, constant_flow(13, 9, {2, -3}));
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(warped.at(4, 5, c), picture.at(6, 2, c));
    EXPECT_EQ(warped.at(12, 1, c), picture.at(12, 0, c));  // continued by the border
  }
}

TEST(Warp, FractionsAreBilinear) {
  const image::Image picture = testing::draw(8, 8, [](Vec2 p) { return 3 * p.x + 5 * p.y; });
  const image::Image warped = warp(picture, constant_flow(8, 8, {0.25, 0.5}));
  EXPECT_NEAR(warped.at(3, 3, 0), 3 * 3.75 + 5 * 4.0, 1e-4);
}

TEST(Warp, LumaIsThatOfTheWarpedPictureRounded) {
  const image::Image picture = test::random_8bit_picture(20, 20, 1, 1);
  const Flow flow = constant_flow(20, 20, {1.3, 0.6});
  EXPECT_EQ(warp(luma_of(picture), flow).v, luma_of(warp(picture, flow)).v);
}

TEST(Warp, TakesTheNextPictureBack) {
  const Vec2 d{3.4, -1.2};
  const image::Image from = testing::moved_texture(96, 64, {});
  const image::Image back = warp(testing::moved_texture(96, 64, d), constant_flow(96, 64, d));
  for (int y = 8; y < 56; ++y) {
    for (int x = 8; x < 88; ++x) EXPECT_NEAR(back.at(x, y, 0), from.at(x, y, 0), 6);
  }
}

TEST(Warp, RefusesAFlowOfAnotherSize) {
  EXPECT_THROW(warp(image::make_image(4, 4, 1), constant_flow(5, 4, {})), Error);
}

TEST(LumaOf, WeighsColours) {
  image::Image picture = image::make_image(1, 1, 3);
  picture.samples = {100, 50, 200};
  EXPECT_EQ(luma_of(picture).v.front(), 82);  // 29.9 + 29.35 + 22.8
}

TEST(LumaOf, NothingIsDarkerThanBlack) {
  image::Image picture = image::make_image(5, 1, 2);
  picture.samples = {200, 0, 0, 255, 255, 255, 0, 127.5F, 82, 255};
  EXPECT_EQ(luma_of(picture).v, (std::vector<std::uint8_t>{0, 64, 255, 32, 125}));
}

TEST(LumaOf, RoundsAndClamps) {
  image::Image picture = image::make_image(4, 1, 1);
  picture.samples = {-3, 10.4F, 10.6F, 300};
  EXPECT_EQ(luma_of(picture).v, (std::vector<std::uint8_t>{0, 10, 11, 255}));
  EXPECT_THROW(luma_of(image::Image{}), Error);
}

}  // namespace
}  // namespace knotreel::motion
