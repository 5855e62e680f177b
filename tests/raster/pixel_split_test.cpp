// SPDX-License-Identifier: GPL-3.0-or-later
#include "raster/pixel_split.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

/// Parts of pixels beside curves, against counting fine points.
namespace knotreel::raster {
namespace {

constexpr std::uint64_t kPixelSplitSeed = 20261123;

/// A path cut into chords that are in any order and go either way.
std::vector<Chord> chords_of(const std::vector<Vec2>& path, std::mt19937_64& random) {
  std::vector<Chord> chords;
  for (std::size_t i = 1; i < path.size(); ++i) {
    chords.push_back({path[i - 1], path[i]});
    if (random() % 2 == 0) std::swap(chords.back().from, chords.back().to);
  }
  std::shuffle(chords.begin(), chords.end(), random);
  return chords;
}

TEST(PixelSplit, PartsAreThoseOnBothSidesOfALine) {
  std::mt19937_64 random(kPixelSplitSeed);
  std::uniform_real_distribution<double> unit(0, 1);
  constexpr int kFine = 200;
  int split = 0;
  for (int i = 0; i < 300; ++i) {
    const int x = static_cast<int>(random() % 50);
    const int y = static_cast<int>(random() % 50);
    const double angle = unit(random) * 6.283185307179586;
    const Vec2 along{std::cos(angle), std::sin(angle)};
    const Vec2 middle{x + unit(random), y + unit(random)};
    std::vector<Vec2> path;
    for (double t = -2; t < 2; t += 0.1 + 0.4 * unit(random)) path.push_back(middle + t * along);
    path.push_back(middle + 2.5 * along);
    const auto parts = split_pixel(chords_of(path, random), x, y);
    if (!parts) continue;  // its ends are close to each other
    ++split;
    int count = 0;
    Vec2 sum{0, 0};
    for (int k = 0; k < kFine * kFine; ++k) {
      const Vec2 p{x + (k % kFine + 0.5) / kFine, y + (k / kFine + 0.5) / kFine};
      const PixelPart& one = (*parts)[0];
      if (cross(along, p - middle) * cross(along, one.centre - middle) <= 0) continue;
      ++count;
      sum = sum + p;
    }
    const PixelPart& one = (*parts)[0];
    const PixelPart& other = (*parts)[1];
    EXPECT_NEAR(one.share, count / double(kFine * kFine), 0.01);
    if (count > 400) {
      EXPECT_LT(norm((1.0 / count) * sum - one.centre), 0.01);
    }
    EXPECT_NEAR(one.share + other.share, 1, 1e-12);
    if (std::min(one.share, other.share) < 1e-5) continue;
    EXPECT_LT(norm(one.share * one.centre + other.share * other.centre - Vec2{x + 0.5, y + 0.5}), 1e-12);
    EXPECT_LT(cross(along, other.centre - middle) * cross(along, one.centre - middle), 0);
  }
  EXPECT_GT(split, 280);
}

TEST(PixelSplit, ALittleBendIsAllowedButNoMore) {
  std::mt19937_64 random(kPixelSplitSeed);
  const auto bent = [&](double by) {
    const std::vector<Vec2> path{{-0.1, 0.5}, {0.5, 0.5 - by}, {1.1, 0.5}};
    return split_pixel(chords_of(path, random), 0, 0);
  };
  const auto little = bent(0.1);
  ASSERT_TRUE(little);
  const double upper = 0.5 * (0.5 - 0.1 / 6 + 0.5 - 0.1);  // two trapezes
  EXPECT_NEAR(std::min((*little)[0].share, (*little)[1].share), std::min(upper, 1 - upper), 1e-12);
  EXPECT_FALSE(bent(0.4));
}

TEST(PixelSplit, ACurveMayLeaveWhereItCameIn) {
  std::mt19937_64 random(kPixelSplitSeed);
  // A triangle behind one of the sides, turned to all of them.
  std::vector<Vec2> path{{1.02, 0.1}, {0.95, 0.5}, {1.02, 0.9}};
  for (int turn = 0; turn < 4; ++turn) {
    for (int i = 0; i < 4; ++i) {
      const auto parts = split_pixel(chords_of(path, random), 0, 0);
      ASSERT_TRUE(parts);
      EXPECT_NEAR(std::min((*parts)[0].share, (*parts)[1].share), 0.5 * 0.05 * (0.8 * 5 / 7), 1e-12);
    }
    for (Vec2& p : path) p = {p.y, 1 - p.x};
  }
}

TEST(PixelSplit, WhatIsNotOnePathFromSideToSideIsLeftAlone) {
  std::mt19937_64 random(kPixelSplitSeed);
  const Vec2 middle{0.4, 0.6};
  const std::vector<Vec2> through{{-0.3, 0.2}, {0.3, 0.3}, {0.8, 0.4}, {1.2, 0.5}};
  const std::vector<Vec2> again{{-0.3, 0.7}, {0.5, 0.75}, {1.2, 0.8}};
  EXPECT_TRUE(split_pixel(chords_of(through, random), 0, 0));
  EXPECT_FALSE(split_pixel({}, 0, 0)) << "nothing";
  EXPECT_FALSE(split_pixel(chords_of({{-0.5, 0.5}, middle}, random), 0, 0)) << "an end";
  std::vector<Chord> chords = chords_of(through, random);
  const std::vector<Chord> more = chords_of(again, random);
  chords.insert(chords.end(), more.begin(), more.end());
  EXPECT_FALSE(split_pixel(chords, 0, 0)) << "two curves";
  const std::vector<Chord> junction{{{-0.5, 0.5}, middle}, {middle, {1.5, 0.5}}, {middle, {0.5, 1.5}}};
  EXPECT_FALSE(split_pixel(junction, 0, 0)) << "three curves";
  EXPECT_FALSE(split_pixel(chords_of({{-0.5, 0.5}, middle, {1.5, 0.5}}, random), 1, 1)) << "beside it";
  const std::vector<Chord> apart{{{-0.5, 0.5}, middle}, {{0.4, std::nextafter(0.6, 1)}, {1.5, 0.5}}};
  EXPECT_FALSE(split_pixel(apart, 0, 0)) << "a gap";
}

}  // namespace
}  // namespace knotreel::raster
