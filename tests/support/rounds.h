// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace knotreel::testing {

/// So many rounds of a long test; a quarter of them in builds with checks, which are many times slower, and
/// look for what any round shows.
constexpr int rounds(int count) {
#ifdef KNOTREEL_CHECKED
  return (count + 3) / 4;
#else
  return count;
#endif
}

}  // namespace knotreel::testing
