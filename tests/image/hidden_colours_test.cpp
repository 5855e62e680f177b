// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/hidden_colours.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knotreel/base/parallel.h"
#include "support/pictures.h"

namespace knotreel::image {
namespace {

/// A disc of a colour that grows darker to the right, opaque but for one pixel at its edge; black where
/// nothing is seen.
Image shaded_disc(int width, int height) {
  Image picture = make_image(width, height, 4);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double in = 0.3 * height - std::hypot(x + 0.5 - 0.5 * width, y + 0.5 - 0.5 * height);
      const float alpha = float(std::round(255 * std::clamp(in + 0.5, 0.0, 1.0)));
      if (alpha == 0) continue;
      picture.at(x, y, 0) = 200 - float(x);
      picture.at(x, y, 1) = 90;
      picture.at(x, y, 2) = 30 + float(y);
      picture.at(x, y, 3) = alpha;
    }
  }
  return picture;
}

TEST(HiddenColours, WhatIsSeenStaysAsItIs) {
  const Image picture = shaded_disc(61, 47);
  const Image extended = extend_seen_colours(picture);
  std::size_t seen = 0;
  for (std::size_t i = 0; i < picture.samples.size(); i += 4) {
    ASSERT_EQ(extended.samples[i + 3], picture.samples[i + 3]);
    if (picture.samples[i + 3] < 16) continue;
    ++seen;
    for (std::size_t c = 0; c < 3; ++c) ASSERT_EQ(extended.samples[i + c], picture.samples[i + c]);
  }
  EXPECT_GT(seen, 500u);
}

TEST(HiddenColours, BecomeThoseBeside) {
  const Image picture = shaded_disc(61, 47);
  const Image extended = extend_seen_colours(picture);
  for (int y = 0; y < 47; ++y) {
    for (int x = 0; x < 61; ++x) {
      // Those of the disc, and next to it those at its edge.
      ASSERT_GE(extended.at(x, y, 0), 200 - 46);
      ASSERT_LE(extended.at(x, y, 0), 200 - 15);
      ASSERT_NEAR(extended.at(x, y, 1), 90, 1e-3);
      const double out = std::hypot(x + 0.5 - 30.5, y + 0.5 - 23.5) - 0.3 * 47;
      if (out < 2) {
        ASSERT_NEAR(extended.at(x, y, 0), 200 - x, 9) << x << " " << y;
      }
    }
  }
}

TEST(HiddenColours, DoNotMatter) {
  const Image picture = shaded_disc(40, 33);
  Image other = picture;
  const Image noise = test::random_picture(40, 33, 4, 1);
  for (std::size_t i = 0; i < other.samples.size(); ++i) {
    if (i % 4 != 3 && other.samples[i - i % 4 + 3] == 0) other.samples[i] = noise.samples[i];
  }
  ASSERT_NE(other.samples, picture.samples);
  EXPECT_TRUE(extend_seen_colours(other).samples == extend_seen_colours(picture).samples);
}

TEST(HiddenColours, TwiceIsLikeOnce) {
  const Image once = extend_seen_colours(shaded_disc(53, 64));
  EXPECT_TRUE(extend_seen_colours(once).samples == once.samples);
}

TEST(HiddenColours, AreFaintOnesBesideWhatIsSeenToo) {
  const Image row{4, 1, 2, {250, 9, 100, 255, 100, 255, 3, 9}};
  EXPECT_EQ(extend_seen_colours(row).samples, (std::vector<float>{100, 9, 100, 255, 100, 255, 100, 9}));
  const Image faint{3, 1, 2, {250, 9, 100, 9, 30, 15}};
  EXPECT_EQ(extend_seen_colours(faint).samples, faint.samples) << "that is all there is to see";
}

TEST(HiddenColours, OfNothingAreBlack) {
  const Image clear{2, 1, 4, {1, 2, 3, 0, 4, 5, 6, 0}};
  EXPECT_EQ(extend_seen_colours(clear).samples, std::vector<float>(8, 0));
}

TEST(HiddenColours, AreNotThereWithoutAlpha) {
  for (const int channels : {1, 3}) {
    const Image picture = test::random_picture(9, 8, channels, 1);
    EXPECT_EQ(extend_seen_colours(picture).samples, picture.samples);
  }
}

TEST(HiddenColours, ThreadsDoNotShow) {
  const Image picture = shaded_disc(200, 150);
  const Image many = extend_seen_colours(picture);
  const ThreadCap cap(1);
  EXPECT_TRUE(extend_seen_colours(picture).samples == many.samples);
}

}  // namespace
}  // namespace knotreel::image
