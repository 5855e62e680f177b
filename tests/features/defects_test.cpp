// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/chain_defects.h"

#include <gtest/gtest.h>

#include <random>

#include "features/drawings.h"
#include "features/untangle.h"
#include "knotreel/features/detect.h"
#include "support/pictures.h"

namespace knotreel::features {
namespace {

using testing::chain_through;
using testing::square_chain;

FeatureChains some_chains() {
  FeatureChains chains{40, 40, {}, 4};
  chains.chains.push_back(chain_through({{4, 4}, {5, 4}, {6, 5}, {7, 6}, {8, 6}}, 0, 1));
  chains.chains.push_back(chain_through({{8, 6}, {9, 5}, {10, 4}, {11, 4}}, 1, 2));
  chains.chains.push_back(chain_through({{8, 6}, {8, 7}, {8, 8}, {8, 9}, {8, 10}}, 1, 3));
  chains.chains.push_back(square_chain(20, 20, 8));
  return chains;
}

void expect_defect(const FeatureChains& chains, const std::string& what) {
  const auto defect = find_defect(chains);
  ASSERT_TRUE(defect) << what;
  EXPECT_NE(defect->find(what), std::string::npos) << *defect << ", not " << what;
}

TEST(Defects, SoundChainsHaveNone) {
  const auto defect = find_defect(some_chains());
  EXPECT_FALSE(defect) << *defect;
  EXPECT_FALSE(find_defect(FeatureChains{}));
}

TEST(Defects, EachIsFound) {
  const auto broken = [](auto change, const std::string& what) {
    FeatureChains chains = some_chains();
    change(chains.chains, chains);
    expect_defect(chains, what);
  };
  using List = std::vector<Chain>;
  broken([](List& c, auto&) { c[0].points.resize(1); }, "fewer than two");
  broken([](List& c, auto&) { c[3].points.resize(7); }, "fewer than eight");
  broken([](List& c, auto&) { c[3].points.resize(12); }, "does not close");
  broken([](List& c, auto&) { c[0].points.erase(c[0].points.begin() + 2); }, "jumps");
  broken([](List& c, auto&) { c[0].points[2] = c[0].points[1]; }, "jumps");
  broken([](List&, FeatureChains& f) { f.height = 24; }, "outside");
  broken([](List& c, auto&) { c[0].points[2].position.x += 1.1; }, "more than a pixel");
  broken([](List& c, auto&) { c[0].points[2].position.y = std::nan(""); }, "more than a pixel");
  broken([](List& c, auto&) { c[2].points[0].position.x += 0.1; }, "two places");
  broken([](List& c, auto&) { c[2].first_node = 3; }, "meet");
  broken([](List& c, auto&) { c[0].first_node = 4; }, "not counted");
  broken([](List& c, auto&) { c[0].first_on_border = true; }, "border");
  broken([](List& c, auto&) { c[3].first_on_border = true; }, "closed chain has an end");
  broken([](List& c, auto&) { c.push_back(c[3]); }, "used twice");
  broken(
      [](List& c, FeatureChains& f) {
        f.node_count = 6;
        c.push_back(chain_through({{12, 10}, {11, 10}, {10, 10}, {9, 9}}, 4, 5));
      },
      "touch");
  broken(
      [](List& c, FeatureChains& f) {
        f.node_count = 6;
        c.push_back(chain_through({{3, 5}, {4, 6}, {5, 5}, {6, 4}, {7, 3}}, 4, 5));
      },
      "touch");
  broken([](List& c, auto&) { c[0].points[2].position = {8.2, 6.5}; }, "more than a pixel");
  broken(
      [](List& c, auto&) {
        c[3].points[1].position.x += 1;
        c[3].points[2].position.x -= 1;
      },
      "curves cross");
}

TEST(Defects, CrossingDiagonalsAreFoundNearNodes) {
  FeatureChains chains{20, 20, {}, 3};
  chains.chains.push_back(chain_through({{5, 5}, {6, 6}, {7, 7}}, 0, 1));
  chains.chains.push_back(chain_through({{5, 5}, {6, 5}, {5, 6}, {4, 7}}, 0, 2));
  expect_defect(chains, "diagonal");
}

/// All pairs of steps, by the definition: they share a point that they should not.
std::size_t slow_crossings(const FeatureChains& chains) {
  struct Step {
    ChainPoint a;
    ChainPoint b;
  };
  std::vector<Step> steps;
  for (const Chain& chain : chains.chains) {
    const std::size_t n = chain.points.size();
    for (std::size_t i = 0; i + (chain.closed ? 0 : 1) < n; ++i) {
      steps.push_back({chain.points[i], chain.points[(i + 1) % n]});
    }
  }
  const auto same = [](const ChainPoint& p, const ChainPoint& q) { return p.x == q.x && p.y == q.y; };
  std::size_t count = 0;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    bool crosses = false;
    for (std::size_t j = 0; j < steps.size() && !crosses; ++j) {
      const Step& s = steps[i];
      const Step& t = steps[j];
      if (i == j || same(s.a, t.a) || same(s.a, t.b) || same(s.b, t.a) || same(s.b, t.b)) continue;
      const Vec2 v = s.b.position - s.a.position;
      const Vec2 w = t.b.position - t.a.position;
      const Vec2 d = t.a.position - s.a.position;
      const double turn = cross(v, w);
      const double along = cross(d, w) / turn;
      const double across = cross(d, v) / turn;
      crosses = along >= 0 && along <= 1 && across >= 0 && across <= 1;
    }
    count += crosses ? 1 : 0;
  }
  return count;
}

TEST(Defects, CrossingsAreThoseOfTheSlowReference) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t total = 0;
  for (unsigned seed = 0; seed < 10; ++seed) {
    DetectOptions options;
    options.min_weight = 0;
    options.min_length = 8;
    FeatureChains chains = detect_features(test::random_picture(60, 60, 1, seed), options);
    for (Chain& chain : chains.chains) {
      for (std::size_t i = chain.closed ? 0 : 1; i + (chain.closed ? 0 : 1) < chain.points.size(); ++i) {
        ChainPoint& p = chain.points[i];
        p.position = {p.x + 0.5 + unit(random), p.y + 0.5 + unit(random)};
      }
    }
    const std::size_t found = crossing_steps(chains).size();
    EXPECT_EQ(found, slow_crossings(chains));
    total += found;
    untangle(chains, positions_of(chains));
    EXPECT_EQ(crossing_steps(chains).size(), 0U);
    EXPECT_FALSE(find_defect(chains));
  }
  EXPECT_GT(total, 100U);
}

}  // namespace
}  // namespace knotreel::features
