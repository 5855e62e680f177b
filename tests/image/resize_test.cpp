// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/resize.h"

#include <gtest/gtest.h>

#include <random>

namespace knotreel::image {
namespace {

Image random_image(int width, int height) {
  Image image = make_image(width, height, 3);
  std::mt19937 random(1);
  for (float& sample : image.samples) sample = float(random() & 255);
  return image;
}

TEST(Resize, TheSameSizeIsTheSamePicture) {
  const Image image = random_image(17, 9);
  EXPECT_EQ(resize(image, 17, 9).samples, image.samples);
}

TEST(Resize, AConstantStaysAtAnySize) {
  Image image = make_image(13, 7, 4);
  for (float& sample : image.samples) sample = 90;
  for (const auto& [width, height] : {std::pair{1, 1}, {5, 30}, {26, 3}, {640, 360}}) {
    const Image result = resize(image, width, height);
    ASSERT_EQ(result.width, width);
    ASSERT_EQ(result.height, height);
    for (const float sample : result.samples) ASSERT_NEAR(sample, 90, 1e-3);
  }
}

TEST(Resize, ARampStaysOneAwayFromTheSides) {
  Image image = make_image(40, 30, 1);
  for (int y = 0; y < 30; ++y) {
    for (int x = 0; x < 40; ++x) image.at(x, y, 0) = float(2 * (x + 0.5) + 3 * (y + 0.5));
  }
  for (const auto& [width, height] : {std::pair{20, 15}, {80, 60}, {31, 47}}) {
    const Image result = resize(image, width, height);
    for (int y = height / 6; y < height - height / 6; ++y) {
      for (int x = width / 6; x < width - width / 6; ++x) {
        const double wanted = 2 * (x + 0.5) * 40 / width + 3 * (y + 0.5) * 30 / height;
        // Where the sizes have no common measure, the sampled triangle is not quite even.
        ASSERT_NEAR(result.at(x, y, 0), wanted, 0.5) << width << ' ' << x << ' ' << y;
      }
    }
  }
}

}  // namespace
}  // namespace knotreel::image
