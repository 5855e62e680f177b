// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/block_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace knotreel::knots {
namespace {

TEST(BlockErrors, KeepsBlocksAboveTheBoundAndNoOthers) {
  constexpr int kWidth = 40;  // blocks of 16, 16 and 8 columns
  constexpr int kHeight = 20;
  std::vector<float> errors(std::size_t{kWidth} * kHeight, 4);  // 2 levels everywhere
  errors[0] += 256 * 12 - 1;                                    // the first block: 4 levels, nearly
  errors[18 * kWidth + 35] += 32 * 12 + 1;  // the last one: 8 by 4 pixels, a little above 4
  const std::vector<float> before = errors;
  EXPECT_EQ(keep_worst_blocks(errors, kWidth, kHeight, 4), 1U);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const std::size_t i = static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x);
      ASSERT_EQ(errors[i], x >= 32 && y >= 16 ? before[i] : 0) << x << ' ' << y;
    }
  }
}

TEST(BlockErrors, ABoundThatIsMetLeavesNothing) {
  std::vector<float> errors(std::size_t{33} * 17, 9);
  EXPECT_EQ(keep_worst_blocks(errors, 33, 17, 2.9), 6U);
  EXPECT_EQ(keep_worst_blocks(errors, 33, 17, 3), 0U);
  EXPECT_TRUE(std::all_of(errors.begin(), errors.end(), [](float e) { return e == 0; }));
}

}  // namespace
}  // namespace knotreel::knots
