// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/suggestion.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace knotreel::cli {

namespace {

/// Letters to change, insert, take away or swap with the next one, to make one word of another.
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  std::iota(d[0].begin(), d[0].end(), 0U);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    d[i][0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      d[i][j] =
          std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0U : 1U)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

std::string suggestion(const std::string& given, std::span<const std::string> names) {
  constexpr std::size_t kLongest = 64;  // what is longer is no slip of the fingers
  if (given.size() > kLongest) return "";
  const std::string* nearest = nullptr;
  std::size_t least = std::max<std::size_t>(1, given.size() / 4) + 1;
  for (const std::string& name : names) {
    const std::size_t d = distance(given, name);
    if (d >= least) continue;
    least = d;
    nearest = &name;
  }
  return nearest ? "; did you mean '" + *nearest + "'?" : "";
}

}  // namespace knotreel::cli
