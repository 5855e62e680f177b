// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/two_colours.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace knotreel::image {
namespace {

Image three_by_three(std::initializer_list<float> samples) {
  Image picture = make_image(3, 3, 1);
  std::copy(samples.begin(), samples.end(), picture.samples.begin());
  return picture;
}

TEST(TwoColours, ArePlainStepsOnly) {
  EXPECT_TRUE(has_two_colours(three_by_three({0, 0, 255, 0, 255, 255, 0, 255, 255}), 0, 0));
  EXPECT_TRUE(has_two_colours(three_by_three({10, 12, 200, 11, 201, 200, 10, 199, 202}), 0, 0));
  EXPECT_FALSE(has_two_colours(three_by_three({0, 128, 255, 0, 255, 255, 0, 255, 255}), 0, 0));
  EXPECT_FALSE(has_two_colours(three_by_three({7, 7, 7, 7, 7, 7, 7, 7, 7}), 0, 0)) << "one colour";
  EXPECT_FALSE(has_two_colours(three_by_three({7, 7, 9, 7, 7, 9, 7, 7, 9}), 0, 0)) << "hardly different";
}

TEST(TwoColours, AreThoseOfTheChannelThatDiffersMost) {
  Image picture = make_image(3, 3, 2);
  for (int y = 0; y < 3; ++y) {
    for (int x = 0; x < 3; ++x) {
      picture.at(x, y, 0) = x < 1 ? 0.0F : 200.0F;
      picture.at(x, y, 1) = 20.0F * static_cast<float>(x);
    }
  }
  EXPECT_TRUE(has_two_colours(picture, 0, 0));
  picture.at(1, 1, 0) = 100;
  EXPECT_FALSE(has_two_colours(picture, 0, 0));
}

}  // namespace
}  // namespace knotreel::image
