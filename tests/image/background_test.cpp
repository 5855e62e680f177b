// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/background.h"

#include <gtest/gtest.h>

namespace knotreel::image {
namespace {

TEST(Background, OfAColourMakesColourPicturesOfGreyOnes) {
  const Image grey{2, 1, 2, {100, 255, 100, 0}};
  EXPECT_EQ(channels_on(Background{{255, 0, 51}}, 2), 3);
  const Image on_red = on_background(grey, Background{{255, 0, 51}});
  EXPECT_EQ(on_red.channels, 3);
  EXPECT_EQ(on_red.samples, (std::vector<float>{100, 100, 100, 255, 0, 51}));
}

TEST(Background, OfGreyLeavesGreyPicturesGrey) {
  const Image on_grey = on_background(Image{2, 1, 2, {100, 255, 100, 0}}, Background{{40, 40, 40}});
  EXPECT_EQ(on_grey.channels, 1);
  EXPECT_EQ(on_grey.samples, (std::vector<float>{100, 40}));
}

TEST(Background, TakesTheAlphaFromColourPictures) {
  const Image picture = on_background(Image{2, 1, 4, {1, 2, 3, 255, 1, 2, 3, 0}}, Background{{7, 8, 9}});
  EXPECT_EQ(picture.channels, 3);
  EXPECT_EQ(picture.samples, (std::vector<float>{1, 2, 3, 7, 8, 9}));
}

TEST(Background, IsNothingWithoutAlpha) {
  for (const int channels : {1, 3}) EXPECT_EQ(channels_on(Background{{255, 0, 0}}, channels), channels);
  for (const int channels : {1, 2, 3, 4}) EXPECT_EQ(channels_on({}, channels), channels);
}

}  // namespace
}  // namespace knotreel::image
