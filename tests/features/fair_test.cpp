// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/fair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "features/chain_defects.h"
#include "features/drawings.h"
#include "knotreel/base/error.h"
#include "knotreel/features/detect.h"

namespace knotreel::features {
namespace {

using testing::chain_through;
using testing::square_chain;

constexpr double kAnywhere = 9;  // pixels; more than points are allowed to go

TEST(Fair, IsTheEquationOfThePaper) {
  FeatureChains chains{40, 40, {square_chain(5, 5, 12)}, 0};
  const auto before = chains.chains[0].points;
  fair_chains(chains, {.lambda = 0.3, .iterations = 1, .keep_size = false, .max_shift = kAnywhere});
  const std::size_t n = before.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto at = [&](std::size_t k) { return before[(i + n + k - 2) % n].position; };
    const Vec2 expected = 0.7 * at(2) + 0.3 / 4 * (at(0) + at(1) + at(3) + at(4));
    EXPECT_NEAR(norm(chains.chains[0].points[i].position - expected), 0, 1e-12);
  }
}

TEST(Fair, StraightLinesStayAndNodesStay) {
  FeatureChains chains{40, 40, {}, 2};
  chains.chains.push_back(chain_through({{2, 3}, {3, 3}, {4, 3}, {5, 3}, {6, 3}, {7, 3}}, 0, 1));
  chains.chains[0].points[3].position.y += 0.4;
  fair_chains(chains, {.lambda = 0.5, .iterations = 1, .keep_size = false, .max_shift = kAnywhere});
  const auto& points = chains.chains[0].points;
  EXPECT_EQ(points.front().position, (Vec2{2.5, 3.5}));
  EXPECT_EQ(points.back().position, (Vec2{7.5, 3.5}));
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(points[i].position.x, 2.5 + double(i), 1e-12);
  EXPECT_NEAR(points[1].position.y, 3.5, 1e-12) << "next to the end: its two neighbours only";
  EXPECT_NEAR(points[2].position.y, 3.55, 1e-12);
  EXPECT_NEAR(points[3].position.y, 3.7, 1e-12);
}

TEST(Fair, TwoPointsAndThreeAreFine) {
  FeatureChains chains{40, 40, {}, 4};
  chains.chains.push_back(chain_through({{2, 3}, {3, 4}}, 0, 1));
  chains.chains.push_back(chain_through({{12, 3}, {13, 4}, {14, 4}}, 2, 3));
  fair_chains(chains);
  EXPECT_EQ(chains.chains[0].points[1].position, (Vec2{3.5, 4.5}));
  EXPECT_NE(chains.chains[1].points[1].position, (Vec2{13.5, 4.5}));
}

TEST(Fair, StaircasesBecomeStraight) {
  FeatureChains chains{80, 80, {}, 2};
  Chain chain;
  for (int x = 5; x < 65; ++x) {
    const int y = 10 + x / 3;
    chain.points.push_back({x, y, {x + 0.5, y + 0.5}});
  }
  chain.first_node = 0;
  chain.last_node = 1;
  chains.chains.push_back(chain);
  const auto roughness = [&] {
    double sum = 0;
    const auto& points = chains.chains[0].points;
    for (std::size_t i = 1; i + 1 < points.size(); ++i) {
      sum += norm(points[i - 1].position - 2 * points[i].position + points[i + 1].position);
    }
    return sum;
  };
  const double before = roughness();
  fair_chains(chains, {.max_shift = kAnywhere});
  EXPECT_LT(roughness(), 0.25 * before);
}

TEST(Fair, NeverLeavesItsPixelByMoreThanOne) {
  FeatureChains chains{40, 40, {square_chain(5, 5, 12), square_chain(25, 25, 4)}, 0};
  fair_chains(chains, {.lambda = 1, .iterations = 200, .keep_size = false, .max_shift = kAnywhere});
  bool at_bound = false;
  for (const Chain& chain : chains.chains) {
    for (const ChainPoint& p : chain.points) {
      const double x = std::abs(p.position.x - p.x - 0.5);
      const double y = std::abs(p.position.y - p.y - 0.5);
      EXPECT_LE(x, 1);
      EXPECT_LE(y, 1);
      at_bound = at_bound || x > 0.999 || y > 0.999;
    }
  }
  EXPECT_TRUE(at_bound);
  EXPECT_FALSE(find_defect(chains));
}

TEST(Fair, PointsStayWithinTheShift) {
  FeatureChains chains{40, 40, {square_chain(5, 5, 12), square_chain(25, 25, 4)}, 0};
  const FeatureChains before = chains;
  fair_chains(chains, {.iterations = 20, .keep_size = false, .max_shift = 0.1});
  double furthest = 0;
  for (std::size_t c = 0; c < chains.chains.size(); ++c) {
    for (std::size_t i = 0; i < chains.chains[c].points.size(); ++i)
      furthest =
          std::max(furthest, norm(chains.chains[c].points[i].position - before.chains[c].points[i].position));
  }
  EXPECT_NEAR(furthest, 0.1, 1e-12) << "corners would go further";
}

TEST(Fair, CurvesThatWouldCrossStay) {
  // A corner points at a line one pixel away, and the line bends towards it.
  FeatureChains chains{40, 40, {}, 4};
  chains.chains.push_back(
      chain_through({{5, 5}, {6, 6}, {7, 7}, {8, 8}, {9, 8}, {10, 7}, {11, 6}, {12, 5}}, 0, 1));
  chains.chains.push_back(
      chain_through({{5, 14}, {6, 13}, {7, 12}, {8, 11}, {9, 10}, {10, 11}, {11, 12}, {12, 13}}, 2, 3));
  chains.chains[0].points[3].position.y += 0.9;
  chains.chains[0].points[4].position.y += 0.9;
  ASSERT_FALSE(find_defect(chains));
  fair_chains(chains, {.lambda = 1, .iterations = 30, .keep_size = false, .max_shift = kAnywhere});
  EXPECT_FALSE(find_defect(chains));
}

TEST(Fair, WrongOptionsAreRefused) {
  FeatureChains chains{10, 10, {}, 0};
  EXPECT_THROW(fair_chains(chains, {.lambda = -0.1}), Error);
  EXPECT_THROW(fair_chains(chains, {.lambda = 1.1}), Error);
  EXPECT_THROW(fair_chains(chains, {.lambda = std::nan("")}), Error);
  EXPECT_THROW(fair_chains(chains, {.iterations = -1}), Error);
  EXPECT_THROW(fair_chains(chains, {.max_shift = 0}), Error);
  EXPECT_THROW(fair_chains(chains, {.max_shift = std::nan("")}), Error);
}

}  // namespace
}  // namespace knotreel::features
