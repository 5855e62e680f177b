// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/base/error.h"

#include <gtest/gtest.h>

namespace knotreel {
namespace {

TEST(Error, KindsHaveTheExitCodesOfTheReadme) {
  EXPECT_EQ(exit_code(ErrorKind::kInternal), 1);
  EXPECT_EQ(exit_code(ErrorKind::kInvalidArgument), 2);
  EXPECT_EQ(exit_code(ErrorKind::kInput), 3);
  EXPECT_EQ(exit_code(ErrorKind::kOutput), 4);
  EXPECT_EQ(exit_code(ErrorKind::kInterrupted), 130);
}

}  // namespace
}  // namespace knotreel
