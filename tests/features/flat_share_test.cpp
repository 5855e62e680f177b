// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/flat_share.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "features/drawings.h"

namespace knotreel::features {
namespace {

constexpr unsigned kNoiseSeed = 5;

TEST(FlatShare, RampsAreFlatAndBendsAreNot) {
  const auto ramp = [](double x, double y) { return 20 + 1.7 * x - 0.9 * y; };
  EXPECT_EQ(flat_share(testing::draw(40, 30, ramp)), 1);
  EXPECT_EQ(flat_share(testing::draw(40, 30, [](double x, double y) { return x * x + 0.1 * y; })), 0);
  // One of the two directions is enough.
  EXPECT_EQ(flat_share(testing::draw(40, 30, [](double x, double y) { return 0.1 * x + y * y; })), 0);
}

TEST(FlatShare, OfADiscAllPixelsButThoseAtItsOutlineAre) {
  const double share = flat_share(testing::disc(64, 31.7, 32.2, 20));
  const double ring = 2 * 3.14159265 * 20 / (62.0 * 62.0);  // one pixel wide
  EXPECT_LT(share, 1 - 1.5 * ring);
  EXPECT_GT(share, 1 - 4 * ring);
}

TEST(FlatShare, NoiseIsNotFlat) {
  SCOPED_TRACE(kNoiseSeed);
  std::mt19937 random(kNoiseSeed);
  std::normal_distribution<double> noise(0, 30);
  EXPECT_LT(flat_share(testing::draw(64, 48, [&](double, double) { return 90 + noise(random); })), 0.1);
}

TEST(FlatShare, DrawingsAreToldFromNoise) {
  SCOPED_TRACE(kNoiseSeed);
  std::mt19937 random(kNoiseSeed);
  std::normal_distribution<double> noise(0, 30);
  EXPECT_TRUE(is_drawing(testing::disc(64, 31.7, 32.2, 20)));
  EXPECT_FALSE(is_drawing(testing::draw(64, 48, [&](double, double) { return 90 + noise(random); })));
}

/// A page with sharp rules on flat ground, of which a part is a photograph: noise.
/// @param slope of the ground, levels per row.
image::Image page_with_photograph(int photograph, double height_of_rules, double slope = 0) {
  std::mt19937 random(kNoiseSeed);
  std::normal_distribution<double> noise(0, 5);
  image::Image page = image::make_image(100, 100, 1);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const double ground = (x % 8 == 0 ? 220 - height_of_rules : 220) - slope * (99 - y);
      page.at(x, y, 0) = float(y < photograph ? 60 + x + noise(random) : ground);
    }
  }
  return page;
}

TEST(FlatShare, DrawingsMayHavePhotographsInThem) {
  SCOPED_TRACE(kNoiseSeed);
  const image::Image page = page_with_photograph(25, 200);
  EXPECT_LT(flat_share(page), 0.5);
  EXPECT_TRUE(is_drawing(page));
  EXPECT_FALSE(is_drawing(page_with_photograph(25, 10, 2))) << "nothing is sharp";
  EXPECT_FALSE(is_drawing(page_with_photograph(60, 200))) << "most of it is a photograph";
}

/// With as many flat pixels, and as sharp edges.
TEST(FlatShare, PagesAreToldFromFilmsByTheirGround) {
  SCOPED_TRACE(kNoiseSeed);
  const image::Image page = page_with_photograph(49, 190), film = page_with_photograph(49, 190, 2);
  EXPECT_NEAR(flat_share(page), flat_share(film), 1e-3);
  EXPECT_TRUE(is_drawing(page));
  EXPECT_FALSE(is_drawing(film));
  image::Image bars = page;  // of a film: black
  for (int y = 49; y < 100; ++y)
    for (int x = 0; x < 100; ++x) bars.at(x, y, 0) = std::abs(bars.at(x, y, 0) - 220);
  EXPECT_FALSE(is_drawing(bars));
  for (const int channels : {2, 3, 4}) {
    EXPECT_TRUE(is_drawing(image::widen_channels(page, channels))) << channels;
    EXPECT_FALSE(is_drawing(image::widen_channels(bars, channels))) << channels << ": alpha is no colour";
  }
}

/// An engraving: lines of two pixels, so many rows apart.
/// @param slope of the paper, levels per column.
image::Image engraving(int distance, double ink = 20, double slope = 0) {
  return testing::draw(100, 100, [=](double x, double y) {
    return int(y) % distance < 2 ? ink : 230 - slope * std::floor(x);
  });
}

TEST(FlatShare, DrawingsMayBeFullOfLines) {
  EXPECT_LT(flat_share(engraving(5)), 0.25);
  EXPECT_TRUE(is_drawing(engraving(5)));
  EXPECT_TRUE(is_drawing(engraving(5, 0))) << "black ink, which is no ground";
  EXPECT_TRUE(is_drawing(engraving(5, 0, 2))) << "paper of any colour, if all is sharp";
  EXPECT_FALSE(is_drawing(engraving(6, 200))) << "nothing is sharp";
  EXPECT_FALSE(is_drawing(engraving(4))) << "nothing is flat";
  EXPECT_TRUE(may_be_drawing(engraving(4)));
  EXPECT_FALSE(may_be_drawing(engraving(4, 0, 2)));
}

/// Black letters of a stroke of two pixels on boxes of some colours, with traces of a codec around.
image::Image table(double contrast) {
  return testing::draw(120, 120, [=](double x, double y) {
    const int column = int(x) % 10, row = int(y) % 10;
    const double box = 150 + 12 * (int(x) / 30) + 20 * (int(y) / 30);
    if (column < 3 && row < 8) return box - contrast;
    return box + (column < 8 ? 1.5 * double((int(x) + int(y)) % 3) : 0.0);
  });
}

TEST(FlatShare, EdgesThatAreAllSharpAreThoseOfDrawings) {
  EXPECT_LT(flat_share(table(130)), 0.3);
  EXPECT_TRUE(is_drawing(table(130)));
  EXPECT_TRUE(may_be_drawing(table(130)));
  EXPECT_FALSE(is_drawing(table(50))) << "nothing is sharp";
}

TEST(FlatShare, LessIsAskedOfPicturesBehindDrawings) {
  SCOPED_TRACE(kNoiseSeed);
  EXPECT_TRUE(may_be_drawing(page_with_photograph(25, 200)));
  EXPECT_TRUE(may_be_drawing(page_with_photograph(25, 10)));
  EXPECT_TRUE(may_be_drawing(testing::disc(64, 31.7, 32.2, 20)));
  EXPECT_FALSE(may_be_drawing(page_with_photograph(60, 200)));
  EXPECT_FALSE(may_be_drawing(page_with_photograph(100, 0)));
}

TEST(FlatShare, EachChannelCounts) {
  image::Image picture = image::make_image(16, 12, 3);
  std::fill(picture.samples.begin(), picture.samples.end(), 50.0F);
  EXPECT_EQ(flat_share(picture), 1);
  for (std::size_t i = 2; i < picture.samples.size(); i += 6) picture.samples[i] = 55;
  EXPECT_EQ(flat_share(picture), 0);
}

TEST(FlatShare, PicturesWithoutAnInsideHaveNone) {
  const auto grey = [](double, double) { return 7.0; };
  EXPECT_EQ(flat_share(testing::draw(1, 1, grey)), 0);
  EXPECT_EQ(flat_share(testing::draw(2, 50, grey)), 0);
  EXPECT_EQ(flat_share(testing::draw(50, 2, grey)), 0);
  EXPECT_EQ(flat_share(testing::draw(3, 3, grey)), 1);
}

TEST(IsClean, DrawingsAreAsTheyAreDrawnAndNotAsCodecsLeaveThem) {
  SCOPED_TRACE(kNoiseSeed);
  image::Image picture = testing::disc(64, 31.7, 32.2, 20);
  EXPECT_TRUE(is_clean(picture));
  std::mt19937 random(kNoiseSeed);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {  // around the edge
      if (std::abs(std::hypot(x - 31.2, y - 31.7) - 20) < 5) picture.at(x, y, 0) += float(random() % 5);
    }
  }
  EXPECT_TRUE(is_drawing(picture));
  EXPECT_FALSE(is_clean(picture));
}

TEST(IsClean, SoftEdgesAreNot) {
  const auto soft = [](double x, double y) {
    return 120 + 90 * std::tanh((std::hypot(x - 32, y - 32) - 20) / 6);
  };
  EXPECT_FALSE(is_clean(testing::draw(64, 64, soft)));
}

void expect_same(const DifferenceCounts& a, const DifferenceCounts& b) {
  EXPECT_EQ(a.flat, b.flat);
  EXPECT_EQ(a.small, b.small);
  EXPECT_EQ(a.large, b.large);
  EXPECT_EQ(a.sharp, b.sharp);
}

TEST(SecondDifferences, WhatIsKnownOfRowsDoesNotShow) {
  SCOPED_TRACE(kNoiseSeed);
  std::mt19937 random(kNoiseSeed);
  image::Image picture = testing::disc(64, 31.7, 32.2, 20);
  SecondDifferences known(picture);
  for (int i = 0; i < 40; ++i) {
    const image::Image before = picture;
    for (unsigned k = random() % 4; k > 0; --k) {  // at the sides, too
      const int y = i % 3 == 0 ? 63 * int(random() % 2) : int(random() % 64);
      picture.at(int(random() % 64), y, 0) += 30;
    }
    known = SecondDifferences(picture, before, known);
    expect_same(known.sum(), SecondDifferences(picture).sum());
  }
}

}  // namespace
}  // namespace knotreel::features
