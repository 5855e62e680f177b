// SPDX-License-Identifier: GPL-3.0-or-later
#include "param/contacts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>
#include <string>

namespace knotreel::param {
namespace {

using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Pairs contacts(const std::vector<Piece>& pieces, double slack) {
  const auto found = find_contacts(pieces, slack);
  Pairs pairs(found.begin(), found.end());
  EXPECT_EQ(pairs.size(), found.size()) << "each once";
  return pairs;
}

/// Of pieces that do not cross.
double distance(const Piece& p, const Piece& q) {
  return std::min({distance_to_segment(p.a, q.a, q.b), distance_to_segment(p.b, q.a, q.b),
                   distance_to_segment(q.a, p.a, p.b), distance_to_segment(q.b, p.a, p.b)});
}

TEST(Contacts, WithSlackWhatIsNearTouches) {
  const std::vector<Piece> pieces{{0, 1, {10, 10}, {30, 10}},
                                  {2, 3, {20, 10.01}, {20, 25}},  // ends beside the first
                                  {4, 5, {17.99, 40}, {10, 50}},  // either side of a cell of 8 pixels, ...
                                  {6, 7, {18.001, 40.002}, {30, 41}},  // ... of which the first begins at 10
                                  {8, 9, {31, 10}, {50, 10}}};
  EXPECT_EQ(contacts(pieces, 0), Pairs{});
  EXPECT_EQ(contacts(pieces, 0.005), Pairs{});
  EXPECT_EQ(contacts(pieces, 0.012), (Pairs{{0, 1}, {2, 3}}));
  EXPECT_EQ(contacts(pieces, 1.0), (Pairs{{0, 1}, {0, 4}, {2, 3}}));
}

TEST(Contacts, WithACommonEndOnlyTheOtherEndsCount) {
  const auto pair = [](Vec2 b, Vec2 c, bool turned) {
    return std::vector<Piece>{{0, 1, {10, 10}, b},
                              turned ? Piece{2, 0, c, {10, 10}} : Piece{0, 2, {10, 10}, c}};
  };
  for (const bool turned : {false, true}) {
    EXPECT_EQ(contacts(pair({40, 10}, {30, 10.004}, turned), 0.005).size(), 1U);
    EXPECT_EQ(contacts(pair({40, 10}, {30, 10.006}, turned), 0.005).size(), 0U);
    EXPECT_EQ(contacts(pair({40, 10}, {50, 10.004}, turned), 0.005).size(), 1U);
    EXPECT_EQ(contacts(pair({40, 10}, {-20, 10.001}, turned), 0.005).size(), 0U) << "straight on";
    EXPECT_EQ(contacts(pair({40, 10}, {30, 40}, turned), 0.005).size(), 0U);
  }
}

TEST(Contacts, OfRandomPiecesAreThoseThatCrossOrAreNear) {
  std::size_t near = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(0, 100), step(-9, 9);
    std::vector<Piece> pieces;
    for (std::uint32_t i = 0; i < 120; ++i) {
      const Vec2 a{place(random), place(random)};
      pieces.push_back({2 * i, 2 * i + 1, a, a + Vec2{step(random), step(random)}});
    }
    const Pairs crossing = contacts(pieces, 0);
    near += contacts(pieces, 0.5).size() - crossing.size();
    for (const double slack : {0.05, 0.5}) {
      Pairs expected = crossing;
      for (std::uint32_t i = 0; i < pieces.size(); ++i) {
        for (std::uint32_t j = i + 1; j < pieces.size(); ++j) {
          if (distance(pieces[i], pieces[j]) <= slack) expected.insert({i, j});
        }
      }
      EXPECT_EQ(contacts(pieces, slack), expected);
    }
  }
  EXPECT_GT(near, 40U);
}

}  // namespace
}  // namespace knotreel::param
