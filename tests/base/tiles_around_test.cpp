// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/tiles_around.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

namespace knotreel {
namespace {

TEST(TilesAround, AreAllThatAreNear) {
  constexpr int kColumns = 7, kRows = 5;
  for (const int distance : {0, 1, 2, 9}) {
    for (int tile = 0; tile < kColumns * kRows; ++tile) {
      std::vector<std::uint8_t> flags(kColumns * kRows, 0);
      flags[std::size_t(tile)] = flags[3] = 1;
      const auto around = tiles_around(flags, kColumns, std::size_t(distance));
      const auto is_near = [&](int a, int b) {
        return std::abs(a % kColumns - b % kColumns) <= distance &&
               std::abs(a / kColumns - b / kColumns) <= distance;
      };
      for (int t = 0; t < kColumns * kRows; ++t)
        ASSERT_EQ(around[std::size_t(t)], is_near(t, tile) || is_near(t, 3) ? 1 : 0) << t << ' ' << tile;
    }
  }
  EXPECT_TRUE(tiles_around({}, 0, 1).empty());
}

}  // namespace
}  // namespace knotreel
