// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/side_ends.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "features/drawings.h"
#include "knotreel/features/corners.h"
#include "knotreel/features/detect.h"
#include "knotreel/features/fair.h"

namespace knotreel::features {
namespace {

constexpr double kHalf = 25;  // of a side of a box, pixels

/// A box with round corners, turned about the middle of a picture of 80 x 80 pixels.
image::Image rounded_box(double radius, double angle) {
  return testing::draw(80, 80, [=](double x, double y) {
    const double along = std::cos(angle) * (x - 40.3) + std::sin(angle) * (y - 39.8);
    const double across = -std::sin(angle) * (x - 40.3) + std::cos(angle) * (y - 39.8);
    const double u = std::max(0.0, std::abs(along) - kHalf + radius);
    const double v = std::max(0.0, std::abs(across) - kHalf + radius);
    return std::hypot(u, v) < radius ? 30.0 : 210.0;
  });
}

/// The eight places where sides become arcs.
std::vector<Vec2> side_ends(double radius, double angle) {
  std::vector<Vec2> ends;
  for (const double u : {-1.0, 1.0}) {
    for (const double v : {-1.0, 1.0}) {
      for (const Vec2 p : {Vec2{u * kHalf, v * (kHalf - radius)}, Vec2{u * (kHalf - radius), v * kHalf}}) {
        ends.push_back({40.3 + std::cos(angle) * p.x - std::sin(angle) * p.y,
                        39.8 + std::sin(angle) * p.x + std::cos(angle) * p.y});
      }
    }
  }
  return ends;
}

FeatureChains marked(const image::Image& picture) {
  FeatureChains chains = detect_features(picture);
  fair_chains(chains);
  sharpen_corners(picture, chains);
  prefer_side_ends(chains);
  return chains;
}

std::vector<Vec2> points_with(bool ChainPoint::*mark, const FeatureChains& chains) {
  std::vector<Vec2> points;
  for (const Chain& chain : chains.chains) {
    for (const ChainPoint& p : chain.points) {
      if (p.*mark) points.push_back(p.on_curve());
    }
  }
  return points;
}

TEST(SideEnds, AreWhereSidesBecomeArcs) {
  for (const double radius : {3.0, 5.0, 8.0, 13.0}) {
    for (const double angle : {0.0, 0.2, 0.6435}) {
      SCOPED_TRACE(::testing::Message() << radius << ", " << angle);
      const std::vector<Vec2> preferred =
          points_with(&ChainPoint::preferred, marked(rounded_box(radius, angle)));
      EXPECT_EQ(preferred.size(), 8U);
      for (const Vec2 end : side_ends(radius, angle)) {
        double least = 1e9;
        for (const Vec2 p : preferred) least = std::min(least, norm(p - end));
        EXPECT_LT(least, 2.5) << end.x << ", " << end.y;
      }
    }
  }
}

/// A wedge with round corners: its tip turns by more than a right angle.
TEST(SideEnds, AreAtTipsOfFewPixels) {
  const double radius = 2.2;
  const Vec2 tip{66.3, 40.4}, upper{16.2, 27.1}, lower{16.2, 53.7};
  const image::Image picture = testing::draw(80, 80, [&](double x, double y) {
    const Vec2 p{x, y};
    const bool inside =
        signed_area(tip, lower, p) > 0 && signed_area(lower, upper, p) > 0 && signed_area(upper, tip, p) > 0;
    const double off = std::min({distance_to_segment(p, tip, lower), distance_to_segment(p, lower, upper),
                                 distance_to_segment(p, upper, tip)});
    return inside || off < radius ? 30.0 : 210.0;
  });
  const std::vector<Vec2> preferred = points_with(&ChainPoint::preferred, marked(picture));
  for (const Vec2 other : {upper, lower}) {
    const Vec2 way = unit(tip - other);
    const Vec2 end = tip + (other == upper ? radius : -radius) * Vec2{way.y, -way.x};
    double least = 1e9;
    for (const Vec2 p : preferred) least = std::min(least, norm(p - end));
    EXPECT_LT(least, 2.5) << end.x << ", " << end.y;
  }
}

TEST(SideEnds, ArcsBetweenThemAreRound) {
  const double radius = 8;
  const FeatureChains chains = marked(rounded_box(radius, 0.2));
  std::size_t arcs = 0;
  for (const ChainPoint& p : chains.chains.at(0).points) {
    const Vec2 d = p.on_curve() - Vec2{40.3, 39.8};
    const double along = std::abs(std::cos(0.2) * d.x + std::sin(0.2) * d.y);
    const double across = std::abs(-std::sin(0.2) * d.x + std::cos(0.2) * d.y);
    const double least = std::min(along, across);  // how far along its side
    if (least < kHalf - radius - 3) {
      EXPECT_FALSE(p.rounded);
    } else if (least > kHalf - radius + 3) {
      ++arcs;
    }
  }
  EXPECT_GT(arcs, 20U);
  EXPECT_GE(points_with(&ChainPoint::rounded, chains).size(), arcs);
}

/// Two straight sides, and between them a point per turn, all a pixel apart.
FeatureChains bend_of(const std::vector<double>& turns) {
  FeatureChains chains;
  chains.width = chains.height = 80;
  Chain& chain = chains.chains.emplace_back();
  Vec2 p{10.5, 20.5};
  double angle = 0.1;
  const auto go_on = [&](double turn) {
    angle += turn;
    p = p + Vec2{std::cos(angle), std::sin(angle)};
    ChainPoint& point = chain.points.emplace_back();
    point.x = static_cast<int>(p.x);
    point.y = static_cast<int>(p.y);
    point.position = p;
  };
  for (int i = 0; i < 20; ++i) go_on(0);
  for (const double turn : turns) go_on(turn);
  for (int i = 0; i < 20; ++i) go_on(0);
  return chains;
}

TEST(SideEnds, OnlyWhatTurnsEvenlyBetweenThemIsRound) {
  FeatureChains even = bend_of(std::vector<double>(12, 0.1));
  prefer_side_ends(even);
  EXPECT_GE(points_with(&ChainPoint::rounded, even).size(), 10U);
  // By as much, but nearly all of it at one place.
  std::vector<double> turns(12, 0.03);
  turns[6] = 0.87;
  FeatureChains uneven = bend_of(turns);
  prefer_side_ends(uneven);
  EXPECT_TRUE(points_with(&ChainPoint::rounded, uneven).empty());
}

TEST(SideEnds, AreNotOnRoundThingsNorAtCorners) {
  for (const double radius : {4.0, 9.0, 17.0, 35.0}) {
    EXPECT_TRUE(points_with(&ChainPoint::preferred, marked(testing::disc(80, 40.2, 39.9, radius))).empty())
        << radius;
  }
  // Of the many, no corner is found: they turn by less than it takes.
  for (const auto& [sides, radius] : {std::pair{4, 30.0}, {6, 30.0}, {12, 20.0}, {18, 35.0}}) {
    std::vector<Vec2> corners;
    for (int i = 0; i < sides; ++i) {
      const double angle = 0.3 + 2 * i * std::numbers::pi / sides;
      corners.push_back(Vec2{40.3, 39.8} + radius * Vec2{std::cos(angle), std::sin(angle)});
    }
    EXPECT_TRUE(points_with(&ChainPoint::preferred, marked(testing::convex_polygon(80, 80, corners))).empty())
        << sides;
  }
}

TEST(SideEnds, DoNotDependOnWhereAChainBegins) {
  const FeatureChains chains = marked(rounded_box(6, 0.2));
  for (const std::ptrdiff_t by : {1, 37, 90}) {
    FeatureChains other = chains;
    std::vector<ChainPoint>& points = other.chains.at(0).points;
    for (ChainPoint& p : points) p.preferred = p.rounded = false;
    std::rotate(points.begin(), points.begin() + by, points.end());
    prefer_side_ends(other);
    std::rotate(points.begin(), points.end() - by, points.end());
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_EQ(points[i].preferred, chains.chains[0].points[i].preferred) << by << ", " << i;
  }
}

TEST(SideEnds, SteppedChainsStayAsTheyAre) {
  FeatureChains chains = marked(rounded_box(8, 0));
  for (Chain& chain : chains.chains) {
    chain.stepped = true;
    for (ChainPoint& p : chain.points) p.preferred = p.rounded = false;
  }
  prefer_side_ends(chains);
  EXPECT_TRUE(points_with(&ChainPoint::preferred, chains).empty());
  EXPECT_TRUE(points_with(&ChainPoint::rounded, chains).empty());
}

}  // namespace
}  // namespace knotreel::features
