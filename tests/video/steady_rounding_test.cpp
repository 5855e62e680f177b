// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "clips.h"
#include "support/pictures.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::largest_difference;
using test::TempDir;

constexpr int kPatternWidth = 37, kPatternHeight = 23;

/// What is read of pictures that are written without loss.
WholeClip written(const std::vector<image::Image>& pictures, const std::string& pixel_format) {
  const TempDir dir;
  ClipSpec clip =
      moving_pattern(kPatternWidth, kPatternHeight, pictures.front().channels, int(pictures.size()));
  clip.images = pictures;
  clip.info.pixel_format = pixel_format;
  if (pixel_format.ends_with("10le")) clip.info.depth = 10;
  write_clip(dir / "a.mkv", clip, with_codec("ffv1", pixel_format));
  return read_clip(dir / "a.mkv");
}

TEST(SteadyRounding, SamplesStayUntilTheyAreFarOff) {
  std::vector<image::Image> pictures;
  for (const float level : {100.0F, 100.45F, 100.55F, 100.69F, 100.75F, 100.45F, 100.31F, 100.29F, 7.0F}) {
    pictures.push_back(image::make_image(kPatternWidth, kPatternHeight, 1));
    std::fill(pictures.back().samples.begin(), pictures.back().samples.end(), level);
  }
  const WholeClip back = written(pictures, "gray");
  const float wanted[] = {100, 100, 100, 100, 101, 101, 101, 100, 7};
  ASSERT_EQ(back.frames.size(), std::size(wanted));
  for (std::size_t i = 0; i < std::size(wanted); ++i)
    EXPECT_EQ(back.frames[i].image.at(5, 7, 0), wanted[i]) << "frame " << i;
}

class Steady : public testing::TestWithParam<const char*> {};

TEST_P(Steady, WhatHardlyChangesDoesNotFlicker) {
  std::vector<image::Image> pictures;
  const image::Image still = test::random_picture(kPatternWidth, kPatternHeight, 4, 1);
  for (unsigned i = 0; i < 4; ++i) {
    pictures.push_back(still);
    const image::Image noise = test::random_picture(kPatternWidth, kPatternHeight, 4, 2 + i);
    for (std::size_t k = 0; k < still.samples.size(); ++k)
      pictures.back().samples[k] += 0.03F * (noise.samples[k] / 127.5F - 1);
  }
  const WholeClip back = written(pictures, GetParam());
  ASSERT_EQ(back.frames.size(), 4u);
  for (std::size_t i = 1; i < 4; ++i)
    EXPECT_EQ(largest_difference(back.frames[i].image, back.frames[0].image), 0) << "frame " << i;
}

INSTANTIATE_TEST_SUITE_P(Formats, Steady,
                         testing::Values("gray", "bgr0", "bgra", "yuv420p", "yuv444p", "yuva420p",
                                         "yuv420p10le", "yuv422p10le"));

TEST(SteadyRounding, NoSampleIsFarOff) {
  const unsigned seed = std::random_device()();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::normal_distribution<float> step(0, 0.2F);
  std::vector<image::Image> pictures{test::random_picture(kPatternWidth, kPatternHeight, 3, seed)};
  for (float& s : pictures[0].samples) s = 20 + s * 0.8F;
  for (int i = 1; i < 12; ++i) {
    pictures.push_back(pictures.back());
    for (float& s : pictures.back().samples) s += step(random);
  }
  const WholeClip back = written(pictures, "bgr0");
  ASSERT_EQ(back.frames.size(), pictures.size());
  std::size_t changes = 0, changes_of_nearest = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    EXPECT_LE(largest_difference(back.frames[i].image, pictures[i]), 0.7 + 1e-3);
    for (std::size_t k = 0; i > 0 && k < pictures[i].samples.size(); ++k) {
      changes += back.frames[i].image.samples[k] != back.frames[i - 1].image.samples[k];
      changes_of_nearest += std::round(pictures[i].samples[k]) != std::round(pictures[i - 1].samples[k]);
    }
  }
  EXPECT_LT(double(changes), 0.6 * double(changes_of_nearest));
}

}  // namespace
}  // namespace knotreel::video
