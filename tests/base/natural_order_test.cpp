// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/base/natural_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace knotreel {
namespace {

TEST(NaturalOrder, DigitsCountAsNumbers) {
  const std::vector<std::string> sorted{"", "1", "a", "a1", "a01b", "a2", "a10", "a10b", "b3", "b20"};
  std::vector<std::string> names(sorted.rbegin(), sorted.rend());
  std::sort(names.begin(), names.end(), natural_less);
  EXPECT_EQ(names, sorted);
}

TEST(NaturalOrder, IsStrict) {
  EXPECT_FALSE(natural_less("a1", "a1"));
  EXPECT_NE(natural_less("a1", "a01"), natural_less("a01", "a1"));
  EXPECT_TRUE(natural_less("9", "99999999999999999999999"));
}

}  // namespace
}  // namespace knotreel
