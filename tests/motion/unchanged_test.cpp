// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/unchanged.h"

#include <gtest/gtest.h>

#include <random>

#include "knotreel/base/error.h"
#include "motion/changed_boxes.h"
#include "motion/scenes.h"

namespace knotreel::motion {
namespace {

constexpr int kUnchangedWidth = 70;  // neither is a whole number of cells
constexpr int kUnchangedHeight = 43;
constexpr int kColumns = 9;
constexpr int kRows = 6;

image::Image noise(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  image::Image picture = image::make_image(kUnchangedWidth, kUnchangedHeight, 3);
  for (float& v : picture.samples) v = static_cast<float>(random() % 256);
  return picture;
}

TEST(UnchangedCells, AreThoseWithoutAnyOtherPixel) {
  std::mt19937_64 random(5);
  const image::Image before = noise(1);
  for (int n = 0; n < 100; ++n) {
    image::Image now = before;
    std::vector<std::uint8_t> expected(kColumns * kRows, 1);
    for (int k = 0; k < n % 4; ++k) {
      const int x = static_cast<int>(random() % kUnchangedWidth);
      const int y = static_cast<int>(random() % kUnchangedHeight);
      now.at(x, y, static_cast<int>(random() % 3)) += 0.25F;
      expected[std::size_t(y / kCellSide * kColumns + x / kCellSide)] = 0;
    }
    ASSERT_EQ(unchanged_cells(before, now), expected);
  }
}

TEST(UnchangedCells, RefuseAnotherSize) {
  EXPECT_THROW(unchanged_cells(noise(1), image::make_image(kUnchangedWidth, kUnchangedHeight - 1, 3)), Error);
  EXPECT_THROW(unchanged_cells(noise(1), image::make_image(kUnchangedWidth, kUnchangedHeight, 1)), Error);
  Rest rest(2);
  rest.start(kUnchangedWidth, kUnchangedHeight);
  EXPECT_THROW(rest.add(std::vector<std::uint8_t>(kColumns * kRows - 1, 1)), Error);
}

/// Against the histories of all cells, one by one.
TEST(Rest, HoldsWhereAllCellsHaveStayedLongEnough) {
  std::mt19937_64 random(7);
  constexpr int kFrames = 3;
  Rest rest(kFrames);
  EXPECT_FALSE(rest.holds({0, 0}, {1, 1}));
  rest.start(kUnchangedWidth, kUnchangedHeight);
  std::vector<int> age(kColumns * kRows, 0);
  for (int frame = 0; frame < 40; ++frame) {
    std::vector<std::uint8_t> unchanged(age.size());
    for (std::size_t i = 0; i < age.size(); ++i) {
      unchanged[i] = random() % 8 > 0 ? 1 : 0;
      age[i] = unchanged[i] ? age[i] + 1 : 0;
    }
    rest.add(unchanged);
    const auto rests = [&](int column, int row) {
      return age[std::size_t(row * kColumns + column)] >= kFrames;
    };
    int resting = 0;
    for (int row = 0; row < kRows; ++row) {
      for (int column = 0; column < kColumns; ++column) {
        resting += rests(column, row) ? 1 : 0;
        ASSERT_EQ(rest.at(std::min(column * kCellSide + 7, kUnchangedWidth - 1), row * kCellSide),
                  rests(column, row));
      }
    }
    ASSERT_DOUBLE_EQ(rest.share(), double(resting) / double(age.size()));
    std::uniform_real_distribution<double> place(-20, 90);
    for (int n = 0; n < 50; ++n) {
      const Vec2 low{place(random), place(random)};
      const Vec2 high = low + Vec2{static_cast<double>(random() % 30), static_cast<double>(random() % 30)};
      const auto cell = [](double at, int count) {
        return std::clamp(static_cast<int>(std::floor(at / kCellSide)), 0, count - 1);
      };
      bool all = true;
      for (int row = cell(low.y, kRows); row <= cell(high.y, kRows); ++row) {
        for (int column = cell(low.x, kColumns); column <= cell(high.x, kColumns); ++column)
          all = all && rests(column, row);
      }
      ASSERT_EQ(rest.holds(low, high), all);
    }
  }
  rest.start(kUnchangedWidth, kUnchangedHeight);
  EXPECT_EQ(rest.share(), 0);
}

TEST(ChangedBoxes, HoldWhatChangesWithItsMarginAndNoPixelTwice) {
  std::mt19937_64 random(9);
  constexpr int kMargin = 5;
  for (int n = 0; n < 300; ++n) {
    std::vector<std::uint8_t> unchanged(kColumns * kRows, 1);
    for (int k = 0; k < n % 7; ++k) unchanged[random() % unchanged.size()] = 0;
    std::vector<int> covered(kUnchangedWidth * kUnchangedHeight, 0);
    for (const PixelBox& box : changed_boxes(unchanged, kUnchangedWidth, kUnchangedHeight, kMargin)) {
      for (int y = box.top; y < box.bottom; ++y) {
        for (int x = box.left; x < box.right; ++x) ++covered[std::size_t(y * kUnchangedWidth + x)];
      }
    }
    EXPECT_TRUE(std::none_of(covered.begin(), covered.end(), [](int times) { return times > 1; }));
    for (int y = 0; y < kUnchangedHeight; ++y) {
      for (int x = 0; x < kUnchangedWidth; ++x) {
        if (unchanged[std::size_t(y / kCellSide * kColumns + x / kCellSide)]) continue;
        for (const int dy : {-kMargin, 0, kMargin}) {
          for (const int dx : {-kMargin, 0, kMargin}) {
            const int i = std::clamp(x + dx, 0, kUnchangedWidth - 1);
            const int j = std::clamp(y + dy, 0, kUnchangedHeight - 1);
            ASSERT_EQ(covered[std::size_t(j * kUnchangedWidth + i)], 1) << i << ", " << j;
          }
        }
      }
    }
  }
}

/// A textured square that moves before a texture at rest.
image::Image square_at(double left) {
  const testing::Texture behind(1);
  const testing::Texture square(2);
  return testing::draw(320, 200, [&](Vec2 p) {
    const Vec2 q = p - Vec2{left, 60};
    return q.x >= 0 && q.y >= 0 && q.x < 60 && q.y < 60 ? square(q) : behind(p);
  });
}

TEST(FlowInParts, IsThatOfTheWholeWhereSomethingMoves) {
  const image::Image before = square_at(40);
  const image::Image now = square_at(44);
  const std::vector<std::uint8_t> unchanged = unchanged_cells(before, now);
  const FlowPair whole = find_flow_pair(luma_of(before), luma_of(now));
  const FlowPair parts = find_flow_pair(luma_of(before), luma_of(now), unchanged);
  ASSERT_EQ(parts.forward.xy.size(), whole.forward.xy.size());
  for (int y = 75; y < 105; ++y) {
    for (int x = 55; x < 85; ++x) {
      const Vec2 p{x + 0.5, y + 0.5};
      ASSERT_NEAR(parts.forward.at(p).x, 4, 0.6) << x << ", " << y;
      ASSERT_LT(norm(parts.forward.at(p) - whole.forward.at(p)), 0.3) << x << ", " << y;
      ASSERT_LT(norm(parts.backward.at(p) - whole.backward.at(p)), 0.3) << x << ", " << y;
      ASSERT_TRUE(parts.consistent[std::size_t(y * 320 + x)]);
    }
  }
  // Far from the square nothing moves at all.
  for (int y = 0; y < 200; ++y) {
    for (int x = 160; x < 320; ++x) {
      const std::size_t i = std::size_t(y * 320 + x);
      ASSERT_EQ(parts.forward.xy[2 * i], 0);
      ASSERT_EQ(parts.backward.xy[2 * i + 1], 0);
      ASSERT_TRUE(parts.consistent[i] && parts.consistent_back[i]);
    }
  }
}

TEST(FlowInParts, IsTheSameWhereAllMoves) {
  const image::Image before = testing::moved_texture(160, 120, {});
  const image::Image now = testing::moved_texture(160, 120, {2, 1});
  const FlowPair whole = find_flow_pair(luma_of(before), luma_of(now));
  const FlowPair parts = find_flow_pair(luma_of(before), luma_of(now), unchanged_cells(before, now));
  EXPECT_EQ(parts.forward.xy, whole.forward.xy);
  EXPECT_EQ(parts.backward.xy, whole.backward.xy);
  EXPECT_EQ(parts.consistent, whole.consistent);
}

TEST(Pictures, WithoutTheValuesThatTheyTellOfAreRefused) {
  const image::Image whole = image::make_image(20, 10, 3);
  const image::Image part{20, 10, 3, std::vector<float>(500)};
  EXPECT_THROW(luma_of(part), Error);
  EXPECT_THROW(unchanged_cells(whole, part), Error);
  EXPECT_THROW(find_flow(luma_of(whole), Luma{20, 10, {}}), Error);
}

}  // namespace
}  // namespace knotreel::motion
