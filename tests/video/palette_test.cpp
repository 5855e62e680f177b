// SPDX-License-Identifier: GPL-3.0-or-later
#include "video/palette.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "clips.h"
#include "knotreel/base/parallel.h"
#include "support/pictures.h"
#include "support/temp_dir.h"
#include "video/dither.h"

namespace knotreel::video {
namespace {

using test::largest_difference;
using test::TempDir;

/// A picture in a palette.
struct Drawn {
  explicit Drawn(const image::Image& picture, const Drawn* before = nullptr)
      : palette(choose_palette(picture, before ? &before->palette : nullptr)),
        indices(dithered(picture, palette,
                         before && before->palette.colours == palette.colours
                             ? std::span<const std::uint8_t>(before->indices)
                             : std::span<const std::uint8_t>())) {}

  image::Image image(int width, int height) const {
    image::Image image = image::make_image(width, height, 4);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      const std::uint32_t argb = palette.colours[indices[i]];
      for (std::size_t c = 0; c < 3; ++c) image.samples[4 * i + c] = float(argb >> (16 - 8 * c) & 0xFF);
      image.samples[4 * i + 3] = float(argb >> 24);
    }
    return image;
  }

  Palette palette;
  std::vector<std::uint8_t> indices;
};

/// 160x120, of far more than 256 colours.
image::Image ramps() {
  image::Image picture = image::make_image(160, 120, 3);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      picture.at(x, y, 0) = 1.5F * float(x);
      picture.at(x, y, 1) = 2 * float(y);
      picture.at(x, y, 2) = 240 - float(x);
    }
  }
  return picture;
}

image::Image with_noise(image::Image picture, float most, unsigned seed) {
  const image::Image noise = test::random_picture(picture.width, picture.height, picture.channels, seed);
  for (std::size_t i = 0; i < picture.samples.size(); ++i)
    picture.samples[i] += most * (noise.samples[i] / 127.5F - 1);
  return picture;
}

/// Root mean square, of the colours in blocks of pixels.
double off(const image::Image& drawn, const image::Image& picture, int block) {
  double squares = 0, count = 0;
  for (int y = 0; y + block <= picture.height; y += block) {
    for (int x = 0; x + block <= picture.width; x += block) {
      for (int c = 0; c < 3; ++c) {
        double sum = 0;
        for (int j = 0; j < block; ++j) {
          for (int i = 0; i < block; ++i)
            sum += double{drawn.at(x + i, y + j, c)} - double{picture.at(x + i, y + j, c)};
        }
        squares += std::pow(sum / (block * block), 2);
        ++count;
      }
    }
  }
  return std::sqrt(squares / count);
}

double share_of_changes(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double changes = 0;
  for (std::size_t i = 0; i < a.size(); ++i) changes += a[i] == b[i] ? 0 : 1;
  return changes / double(a.size());
}

TEST(Palette, FewColoursAreKeptExactly) {
  for (const int channels : {1, 3}) {
    image::Image picture = image::make_image(20, 10, channels);
    for (std::size_t i = 0; i < picture.samples.size(); ++i) picture.samples[i] = float(i * i % 13 * 20);
    EXPECT_EQ(largest_difference(Drawn(picture).image(20, 10), image::widen_channels(picture, 4)), 0);
  }
}

TEST(Palette, EveryGreyIsKeptExactly) {
  image::Image picture = image::make_image(16, 16, 1);
  for (std::size_t i = 0; i < 256; ++i) picture.samples[i] = float(i);
  EXPECT_EQ(largest_difference(Drawn(picture).image(16, 16), image::widen_channels(picture, 4)), 0);
}

TEST(Palette, ManyColoursAreNear) {
  const image::Image picture = ramps();
  const Drawn made(picture);
  const image::Image back = made.image(160, 120);
  for (std::size_t i = 3; i < back.samples.size(); i += 4) ASSERT_EQ(back.samples[i], 255);
  // 255 patches of 10 x 7.5 pixels or so: uniform errors of +-7.5, +-7.5 and +-5 levels, and the pattern.
  EXPECT_LT(off(back, picture, 1), 5);
  EXPECT_GT(std::set<std::uint8_t>(made.indices.begin(), made.indices.end()).size(), 240u);
}

TEST(Palette, PatternsHaveTheMeanOfWhatTheyAreFor) {
  // Smoother than the ramps: patterns of 8x8 pixels see the same colour everywhere.
  image::Image picture = image::make_image(320, 320, 3);
  for (int y = 0; y < 320; ++y) {
    for (int x = 0; x < 320; ++x) {
      picture.at(x, y, 0) = 0.75F * float(x);
      picture.at(x, y, 1) = 0.75F * float(y);
      picture.at(x, y, 2) = 120;
    }
  }
  const image::Image back = Drawn(picture).image(320, 320);
  EXPECT_LT(off(back, picture, 8), 0.6 * off(back, picture, 1));
}

TEST(Palette, WhatStaysIsDrawnAsItWas) {
  const image::Image picture = ramps();
  const Drawn first(picture);
  const Drawn second(picture, &first);
  EXPECT_EQ(second.palette.colours, first.palette.colours);
  EXPECT_EQ(second.indices, first.indices);
}

TEST(Palette, NoiseHardlyFlickers) {
  const Drawn first(with_noise(ramps(), 1, 1));
  const image::Image next = with_noise(ramps(), 1, 2);
  const Drawn second(next, &first);
  EXPECT_EQ(second.palette.colours, first.palette.colours);
  const double changes = share_of_changes(first.indices, second.indices);
  EXPECT_LT(changes, 0.2);
  EXPECT_LT(1.5 * changes, share_of_changes(first.indices, dithered(next, first.palette)));
  EXPECT_GT(share_of_changes(first.indices, Drawn(next).indices), 0.8);
}

TEST(Palette, OtherPicturesHaveOtherColours) {
  const Drawn first(ramps());
  image::Image other = ramps();
  for (std::size_t i = 0; i < other.samples.size(); i += 3) std::swap(other.samples[i], other.samples[i + 2]);
  const Drawn second(other, &first);
  EXPECT_NE(second.palette.colours, first.palette.colours);
  EXPECT_LT(off(second.image(160, 120), other, 1), 5);
}

TEST(Palette, AlphaIsAllOrNothing) {
  image::Image picture = test::random_8bit_picture(40, 30, 4, 1);
  const image::Image back = Drawn(picture).image(40, 30);
  for (std::size_t i = 3; i < picture.samples.size(); i += 4)
    ASSERT_EQ(back.samples[i], picture.samples[i] > 127 ? 255 : 0);
  for (std::size_t i = 3; i < picture.samples.size(); i += 4) picture.samples[i] = 0;
  const Drawn nothing(picture);
  EXPECT_EQ(nothing.indices, std::vector<std::uint8_t>(1200, 0));
  const Drawn after(test::random_8bit_picture(40, 30, 4, 1), &nothing);
  EXPECT_GT(after.palette.count, 240u);
}

TEST(Palette, DoesNotDependOnThreads) {
  const image::Image picture = with_noise(ramps(), 8, 1);
  const auto drawn = [&](int threads) {
    const ThreadCap cap(threads);
    return Drawn(picture).indices;
  };
  EXPECT_EQ(drawn(1), drawn(4));
}

TEST(Palette, GifsThatStandStillAreSmall) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(160, 120, 3, 10);
  for (std::size_t t = 0; t < 10; ++t) clip.images[t] = with_noise(ramps(), 0.5F, unsigned(t));
  write_clip(dir / "a.gif", clip);
  clip.images.resize(1);
  clip.pts.resize(1);
  write_clip(dir / "one.gif", clip);
  EXPECT_LT(std::filesystem::file_size(dir / "a.gif"), 4 * std::filesystem::file_size(dir / "one.gif"));
}

}  // namespace
}  // namespace knotreel::video
