// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/enlarge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "knotreel/base/error.h"

namespace knotreel::image {
namespace {

/// Areas of one colour, with the pixels of their outlines mixed: discs drawn with 8x8 samples per pixel.
Image discs(int width, int height, int channels) {
  Image image = make_image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int s = 0; s < 64; ++s) {
        const double px = x + (s % 8 + 0.5) / 8, py = y + (s / 8 + 0.5) / 8;
        const bool inside = std::fmod(std::hypot(px - 0.4 * width, py - 0.55 * height), 9) < 4.3;
        for (int c = 0; c < channels; ++c)
          image.at(x, y, c) += float(inside ? 200 - 30 * c : 20 + 10 * c) / 64;
      }
    }
  }
  return image;
}

float mean_of_four(const Image& image, int x, int y, int c) {
  return 0.25F * (image.at(2 * x, 2 * y, c) + image.at(2 * x + 1, 2 * y, c) + image.at(2 * x, 2 * y + 1, c) +
                  image.at(2 * x + 1, 2 * y + 1, c));
}

TEST(EnlargeTwofold, MeansOfFourPixelsAreThoseOfThePicture) {
  const Image image = discs(40, 31, 3);
  const Image large = enlarge_twofold(image);
  ASSERT_EQ(large.width, 80);
  ASSERT_EQ(large.height, 62);
  double squared = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < 3; ++c) squared += std::pow(mean_of_four(large, x, y, c) - image.at(x, y, c), 2);
    }
  }
  EXPECT_LT(std::sqrt(squared / double(image.samples.size())), 2.5) << "of 60 to 170 levels of contrast";
}

TEST(EnlargeTwofold, NothingLeavesTheRangeAround) {
  std::mt19937 random(3);
  Image image = make_image(17, 12, 2);
  for (float& sample : image.samples) sample = float(random() % 256);
  const Image large = enlarge_twofold(image);
  for (int y = 0; y < large.height; ++y) {
    for (int x = 0; x < large.width; ++x) {
      for (int c = 0; c < 2; ++c) {
        float low = 255, high = 0;
        for (int j = std::max(0, y / 2 - 1); j <= std::min(image.height - 1, y / 2 + 1); ++j) {
          for (int i = std::max(0, x / 2 - 1); i <= std::min(image.width - 1, x / 2 + 1); ++i) {
            low = std::min(low, image.at(i, j, c));
            high = std::max(high, image.at(i, j, c));
          }
        }
        ASSERT_GE(large.at(x, y, c), low);
        ASSERT_LE(large.at(x, y, c), high);
      }
    }
  }
}

TEST(EnlargeTwofold, MirroredPicturesAreMirrored) {
  const Image image = discs(26, 18, 1);
  Image mirrored = image;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) mirrored.at(image.width - 1 - x, y, 0) = image.at(x, y, 0);
  }
  const Image a = enlarge_twofold(image);
  const Image b = enlarge_twofold(mirrored);
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) ASSERT_NEAR(a.at(x, y, 0), b.at(a.width - 1 - x, y, 0), 1e-3);
  }
}

TEST(EnlargeTwofold, EdgesAreSharperThanByInterpolationAlone) {
  // A stroke of one and a half pixels: in the middle it is as dark as it was drawn.
  Image image = make_image(20, 9, 1);
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 20; ++x) image.at(x, y, 0) = x == 9 ? 0.0F : x == 10 ? 127.5F : 255.0F;
  }
  const Image large = enlarge_twofold(image);
  // From 9 to 10.5: samples 18 to 20 are dark, 21 is bright.
  EXPECT_LT(large.at(18, 8, 0), 30);
  EXPECT_LT(large.at(19, 8, 0), 10);
  EXPECT_GT(large.at(21, 8, 0), 150);
  EXPECT_GT(large.at(17, 8, 0), 225);
}

TEST(EnlargeTwofold, ThePictureOfOnePixel) {
  Image image = make_image(1, 1, 4);
  image.samples = {1, 2, 3, 4};
  const Image large = enlarge_twofold(image);
  ASSERT_EQ(large.pixel_count(), 4U);
  for (int c = 0; c < 4; ++c) EXPECT_NEAR(large.at(1, 1, c), float(c + 1), 1e-4);
}

/// It is made in blocks, which are nowhere to be seen.
TEST(EnlargeTwofold, APartIsEnlargedAsItIsInTheWhole) {
  const Image image = discs(300, 150, 3);
  const Image large = enlarge_twofold(image);
  constexpr int kLeft = 37, kTop = 21, kReach = kReachOfEnlarging;
  Image part = make_image(200, 110, 3);
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x)
      for (int c = 0; c < 3; ++c) part.at(x, y, c) = image.at(x + kLeft, y + kTop, c);
  const Image alone = enlarge_twofold(part);
  for (int y = 2 * kReach; y < alone.height - 2 * kReach; ++y)
    for (int x = 2 * kReach; x < alone.width - 2 * kReach; ++x)
      for (int c = 0; c < 3; ++c)
        ASSERT_EQ(alone.at(x, y, c), large.at(x + 2 * kLeft, y + 2 * kTop, c)) << x << ' ' << y;
}

}  // namespace
}  // namespace knotreel::image
