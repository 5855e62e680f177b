// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/predicates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

/// Signs against integers that hold every intermediate result.
namespace knotreel::mesh {
namespace {

__extension__ using Wide = __int128;

struct Whole {
  std::int64_t x, y;
};

Vec2 scaled(Whole p, double unit) {
  return {unit * static_cast<double>(p.x), unit * static_cast<double>(p.y)};
}

int sign(Wide v) {
  return v > 0 ? 1 : v < 0 ? -1 : 0;
}

int exact_orientation(Whole a, Whole b, Whole c) {
  return sign(Wide{b.x - a.x} * (c.y - a.y) - Wide{b.y - a.y} * (c.x - a.x));
}

/// For a, b, c in positive order: 1 if d is inside their circle, 0 if it is on it.
int exact_in_circle(Whole a, Whole b, Whole c, Whole d) {
  const auto row = [d](Whole p) {
    const Wide x = p.x - d.x;
    const Wide y = p.y - d.y;
    return std::array<Wide, 3>{x, y, x * x + y * y};
  };
  const auto [ax, ay, aa] = row(a);
  const auto [bx, by, bb] = row(b);
  const auto [cx, cy, cc] = row(c);
  return sign(aa * (bx * cy - by * cx) - bb * (ax * cy - ay * cx) + cc * (ax * by - ay * bx));
}

TEST(Predicates, OrientationIsExactNextToALine) {
  // The classical case: points a few ulps apart near a diagonal, where doubles give a random pattern.
  constexpr double kUnit = 0x1p-53;
  constexpr std::int64_t kOne = std::int64_t{1} << 53;
  const Whole b{12 * kOne, 12 * kOne};
  const Whole c{24 * kOne, 24 * kOne};
  int zeros = 0;
  int doubles_wrong = 0;
  for (std::int64_t i = 0; i < 64; ++i) {
    for (std::int64_t j = 0; j < 64; ++j) {
      const Whole a{kOne / 2 + i, kOne / 2 + j};
      const int expected = exact_orientation(a, b, c);
      const Vec2 p = scaled(a, kUnit), q = scaled(b, kUnit), r = scaled(c, kUnit);
      ASSERT_EQ(orientation(p, q, r), expected) << i << ' ' << j;
      ASSERT_EQ(orientation(q, p, r), -expected) << i << ' ' << j;
      ASSERT_EQ(orientation(q, r, p), expected) << i << ' ' << j;
      zeros += expected == 0;
      const double area = signed_area(p, q, r);
      doubles_wrong += (area > 0) - (area < 0) != expected;
    }
  }
  EXPECT_EQ(zeros, 64);
  EXPECT_GT(doubles_wrong, 0) << "these cases must be hard";
}

TEST(Predicates, InCircleIsExactForThinTrianglesAndClosePoints) {
  std::mt19937_64 random(20261121);
  const auto count = [&](std::int64_t a, std::int64_t b) {
    return std::uniform_int_distribution<std::int64_t>(a, b)(random);
  };
  int inside = 0;
  int outside = 0;
  for (int i = 0; i < 20000; ++i) {
    // Nearly on the line y = 3 x, with d next to a.
    const auto near_line = [&] {
      const std::int64_t x = count(-(1 << 27), 1 << 27);
      return Whole{x, 3 * x + count(-2, 2)};
    };
    const Whole a = near_line();
    Whole b = near_line();
    Whole c = near_line();
    const int turn = exact_orientation(a, b, c);
    if (turn == 0) continue;
    if (turn < 0) std::swap(b, c);
    const Whole d{a.x + count(-2, 2), a.y + count(-2, 2)};
    const int expected = exact_in_circle(a, b, c, d);
    ASSERT_EQ(in_circle(scaled(a, 1), scaled(b, 1), scaled(c, 1), scaled(d, 1)), expected > 0)
        << "case " << i;
    (expected > 0 ? inside : outside) += 1;
  }
  EXPECT_GT(inside, 1000);
  EXPECT_GT(outside, 1000);
}

TEST(Predicates, PointsOnTheCircleAreNotInside) {
  // Integer points on circles about the origin, turned by quarters, and scaled.
  for (const double scale : {1.0, 1.0 / 3, 1e5 / 7}) {
    const double u = scale * 3;
    const double v = scale * 4;
    EXPECT_FALSE(in_circle({u, v}, {-v, u}, {-u, -v}, {v, -u}));
    EXPECT_FALSE(in_circle({u, v}, {-v, u}, {-u, -v}, {v, u}));
    EXPECT_FALSE(in_circle({u, v}, {-v, u}, {-u, -v}, {std::nextafter(v, 1e9), -u}));
    EXPECT_TRUE(in_circle({u, v}, {-v, u}, {-u, -v}, {std::nextafter(v, 0.0), -u}));
    EXPECT_FALSE(in_circle({u, v}, {-v, u}, {-u, -v}, {u, v})) << "a corner";
  }
}

}  // namespace
}  // namespace knotreel::mesh
