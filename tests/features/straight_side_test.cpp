// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/straight_side.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace knotreel::features {
namespace {

/// The line that fits points best is known, and so is how far they are from it.
double rms_from_line(const std::vector<Vec2>& points) {
  Vec2 mean;
  for (const Vec2 p : points) mean = mean + (1.0 / double(points.size())) * p;
  double xx = 0, xy = 0, yy = 0;
  for (const Vec2 p : points) {
    const Vec2 d = p - mean;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  double sum = 0;
  for (const Vec2 p : points) {
    const double off = cross(Vec2{std::cos(angle), std::sin(angle)}, p - mean);
    sum += off * off;
  }
  return std::sqrt(sum / double(points.size()));
}

struct Stretch {
  std::size_t gap = 0, count = 0;
};

/// From 2 to 5 points away, 4 to 14 points as long as they are within 0.05 px of a line; the longest, and of
/// equal ones the nearest.
Stretch longest_stretch(const ChainWalk& walk, double scale) {
  Stretch best;
  for (std::size_t gap = 2; gap <= 5; ++gap) {
    for (std::size_t count = 4; count <= 14 && gap + count <= walk.steps() + 1; ++count) {
      std::vector<Vec2> points;
      for (std::size_t k = 0; k < count; ++k) points.push_back(walk.at(gap + k));
      if (rms_from_line(points) > 0.05 * scale) break;
      if (count > best.count) best = {gap, count};
    }
  }
  return best;
}

/// Straight, then bent, with noise.
Chain random_chain(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  Chain chain;
  chain.closed = seed % 3 == 0;
  double angle = 3 * number(random), turn = 0;
  const double noise = 0.04 * std::abs(number(random));
  Vec2 p{100, 100};
  for (int i = 0; i < 40; ++i) {
    if (i % 10 == 9) turn = 0.1 * number(random);
    angle += turn;
    p = p + Vec2{std::cos(angle), std::sin(angle)};
    ChainPoint point;
    point.position = p + noise * Vec2{number(random), number(random)};
    chain.points.push_back(point);
  }
  return chain;
}

TEST(StraightSide, IsTheLongestStretchNearTheStartThatIsStraight) {
  int found = 0, none = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Chain chain = random_chain(seed);
    for (std::size_t from = 0; from < chain.points.size(); from += 3) {
      for (const double scale : {1.0, 2.0}) {
        const ChainWalk walk(chain, from, from % 2 == 0);
        const std::optional<StraightSide> side = straight_side(walk, scale);
        const Stretch expected = longest_stretch(walk, scale);
        ASSERT_EQ(side.has_value(), expected.count > 0);
        if (!side) {
          ++none;
          continue;
        }
        ++found;
        EXPECT_EQ(side->gap, expected.gap);
        EXPECT_EQ(side->count, expected.count);
        EXPECT_NEAR(norm(side->away), 1, 1e-12);
        EXPECT_GT(dot(side->away, walk.at(side->gap + side->count - 1) - walk.at(side->gap)), 0);
      }
    }
  }
  EXPECT_GT(found, 1000);
  EXPECT_GT(none, 50);
}

}  // namespace
}  // namespace knotreel::features
