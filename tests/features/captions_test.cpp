// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/captions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>

#include "features/drawings.h"

namespace knotreel::features {
namespace {

constexpr unsigned kCaptionSeed = 11;

/// A meadow: soft hills with some noise.
double ground(double x, double y) {
  return 90 + 50 * std::sin(x / 9) * std::cos(y / 7);
}

/// Letters, more or less: rings of a stroke of two pixels, 12 px apart, on some rows of them.
bool is_ink(double x, double y, double top, int rows) {
  if (y < top || y >= top + 12 * rows) return false;
  const double r = std::hypot(std::fmod(x, 12) - 6, std::fmod(y - top, 12) - 6);
  return r > 2.5 && r < 4.5;
}

image::Image captioned(int rows, double ink = 255, double top = 60) {
  return testing::draw(
      160, 128, [=](double x, double y) { return is_ink(x, y, top, rows) ? ink : ground(x, y) * 0.5; });
}

TEST(Captions, LettersOverFilmAreCounted) {
  const std::size_t one = caption_pixels(captioned(1)), three = caption_pixels(captioned(3));
  // Of a ring, two outlines: 2 pi (2.5 + 4.5) = 44 px, each of which has a pixel or two beside it.
  EXPECT_GT(one, 13U * 40);
  EXPECT_LT(one, 13U * 100);
  EXPECT_NEAR(double(three), 3.0 * double(one), 0.3 * double(three));
}

TEST(Captions, FilmHasNone) {
  SCOPED_TRACE(kCaptionSeed);
  std::mt19937 random(kCaptionSeed);
  std::normal_distribution<double> grain(0, 12);
  EXPECT_EQ(caption_pixels(captioned(0)), 0U);
  EXPECT_EQ(caption_pixels(
                testing::draw(160, 128, [&](double x, double y) { return ground(x, y) + grain(random); })),
            0U);
  EXPECT_EQ(caption_pixels(captioned(3, 140)), 0U) << "not sharper than what a lens sees";
}

TEST(Captions, BarsAndNoiseAreNone) {
  SCOPED_TRACE(kCaptionSeed);
  EXPECT_EQ(
      caption_pixels(testing::draw(
          160, 128, [](double x, double y) { return y < 20.5 || y > 100.5 ? 0 : 140 + ground(x, y) / 2; })),
      0U);
  EXPECT_EQ(caption_pixels(testing::draw(
                160, 128, [](double x, double) { return x < 40 && std::fmod(x, 8) < 4 ? 0.0 : 255.0; })),
            0U);
  std::mt19937 random(kCaptionSeed);
  std::uniform_real_distribution<float> noise(0, 255);
  image::Image picture = image::make_image(160, 128, 3);
  for (float& sample : picture.samples) sample = noise(random);
  EXPECT_EQ(caption_pixels(picture), 0U);
}

TEST(Captions, AMarkInACornerIsNone) {
  const auto mark = [](int width, int height) {
    return testing::draw(width, height,
                         [](double x, double y) { return x < 28 && is_ink(x, y, 4, 1) ? 255.0 : 60.0; });
  };
  EXPECT_GT(caption_pixels(mark(100, 80)), 0U);
  EXPECT_EQ(caption_pixels(mark(400, 320)), 0U);
}

TEST(Captions, WhatIsFullOfLettersIsNoFilm) {
  EXPECT_GT(caption_pixels(captioned(3)), 0U);
  EXPECT_EQ(caption_pixels(captioned(10, 255, 0)), 0U);
}

TEST(Captions, OneColourIsEnoughAndAlphaIsNoColour) {
  const image::Image grey = captioned(2);
  const std::size_t count = caption_pixels(grey);
  const auto only_in = [&](int channel, int channels) {
    image::Image picture = image::make_image(grey.width, grey.height, channels);
    std::fill(picture.samples.begin(), picture.samples.end(), 40.0F);
    for (int y = 0; y < grey.height; ++y)
      for (int x = 0; x < grey.width; ++x) picture.at(x, y, channel) = grey.at(x, y, 0);
    return caption_pixels(picture);
  };
  EXPECT_EQ(only_in(2, 3), count);
  EXPECT_EQ(only_in(1, 4), count);
  EXPECT_EQ(only_in(3, 4), 0U);
  EXPECT_EQ(only_in(1, 2), 0U);
}

/// The obvious way.
std::size_t counted_slowly(const image::Image& image) {
  std::size_t pixels = 0;
  int cells = 0, captions = 0;
  for (int top = 0; top < image.height; top += 16) {
    for (int left = 0; left < image.width; left += 16, ++cells) {
      std::size_t inside = 0, any = 0, sharp = 0, along = 0, across = 0;
      for (int y = top; y < std::min(top + 16, image.height - 1); ++y) {
        for (int x = left; x < std::min(left + 16, image.width - 1); ++x) {
          const float h = std::abs(image.at(x, y, 0) - image.at(x + 1, y, 0));
          const float v = std::abs(image.at(x, y, 0) - image.at(x, y + 1, 0));
          ++inside;
          any += h > 50 || v > 50;
          sharp += h > 128 || v > 128;
          along += h > 128;
          across += v > 128;
        }
      }
      if (along < 6 || across < 6 || double(sharp) < 0.3 * double(any) || double(any) > 0.75 * double(inside))
        continue;
      pixels += any;
      ++captions;
    }
  }
  return captions < 0.01 * cells || captions > 0.4 * cells ? 0 : pixels;
}

TEST(Captions, AreThoseOfTheObviousWay) {
  SCOPED_TRACE(kCaptionSeed);
  std::mt19937 random(kCaptionSeed);
  for (int k = 0; k < 100; ++k) {
    const int width = 30 + int(random() % 90);
    const int height = 17 + int(random() % 90);
    image::Image picture = image::make_image(width, height, 1);
    const auto rarity = 2 + random() % 12;
    float level = 0;
    for (float& sample : picture.samples) {
      if (random() % rarity == 0) level = float(random() % 256);
      sample = level;
    }
    EXPECT_EQ(caption_pixels(picture), counted_slowly(picture)) << k;
  }
}

TEST(Captions, SmallPicturesAreFine) {
  EXPECT_EQ(caption_pixels(image::make_image(1, 1, 1)), 0U);
  EXPECT_EQ(caption_pixels(image::make_image(1, 50, 3)), 0U);
  EXPECT_EQ(caption_pixels(image::make_image(50, 1, 3)), 0U);
}

}  // namespace
}  // namespace knotreel::features
