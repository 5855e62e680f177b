// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

// Builds with checks are many times slower, and look for what any round of a test shows.

namespace knotreel::testing {

#ifdef KNOTREEL_CHECKED
inline constexpr bool kHasChecks = true;
#else
inline constexpr bool kHasChecks = false;
#endif

/// So many rounds of a long test; a quarter of them in builds with checks.
constexpr int rounds(int count) {
  return kHasChecks ? (count + 3) / 4 : count;
}

}  // namespace knotreel::testing

/// At the head of a test that takes long, and goes where shorter ones go.
#define KNOTREEL_SKIP_WITH_CHECKS() \
  if (knotreel::testing::kHasChecks) GTEST_SKIP() << "takes long in a build with checks"
