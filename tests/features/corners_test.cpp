// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/corners.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "features/chain_defects.h"
#include "features/drawings.h"
#include "features/untangle.h"
#include "knotreel/base/error.h"
#include "knotreel/features/detect.h"
#include "knotreel/features/fair.h"
#include "support/rounds.h"

namespace knotreel::features {
namespace {

using testing::draw;

/// Radii to and fro; a polygon if they are the same.
std::vector<Vec2> star(Vec2 centre, double outer, double inner, int tips, double turn) {
  std::vector<Vec2> corners;
  for (int i = 0; i < 2 * tips; ++i) {
    const double angle = turn + i * std::numbers::pi / tips;
    const double radius = i % 2 == 0 ? outer : inner;
    corners.push_back(centre + radius * Vec2{std::cos(angle), std::sin(angle)});
  }
  return corners;
}

std::vector<Vec2> polygon(Vec2 centre, double radius, int sides, double turn) {
  std::vector<Vec2> corners;
  for (int i = 0; i < sides; ++i) {
    const double angle = turn + 2 * i * std::numbers::pi / sides;
    corners.push_back(centre + radius * Vec2{std::cos(angle), std::sin(angle)});
  }
  return corners;
}

bool inside(const std::vector<Vec2>& corners, Vec2 p) {
  bool in = false;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 a = corners[i];
    const Vec2 b = corners[(i + 1) % corners.size()];
    if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) in = !in;
  }
  return in;
}

image::Image filled(const std::vector<Vec2>& corners, int width = 100, int height = 90) {
  return draw(width, height, [&](double x, double y) { return inside(corners, {x, y}) ? 40.0 : 230.0; });
}

FeatureChains curves_of(const image::Image& picture) {
  FeatureChains chains = detect_features(picture);
  fair_chains(chains);
  return chains;
}

double distance(const FeatureChains& chains, Vec2 p, bool corners_only) {
  double least = 1e9;
  for (const Chain& chain : chains.chains) {
    for (const ChainPoint& q : chain.points) {
      if (q.corner || !corners_only) least = std::min(least, norm(q.on_curve() - p));
    }
  }
  return least;
}

TEST(Corners, AreWhereTheyWereDrawn) {
  int shape = 0;
  for (const std::vector<Vec2>& corners :
       {polygon({50.3, 44.8}, 30, 3, 0.2), polygon({50.3, 44.8}, 30, 4, 0.4), polygon({50, 45}, 33.4, 5, 0.1),
        polygon({50.3, 44.8}, 30, 6, 0.9), star({49.6, 45.2}, 35, 15, 5, 0.3),
        star({49.6, 45.2}, 35, 16, 4, 0.5)}) {
    SCOPED_TRACE(shape++);
    const image::Image picture = filled(corners);
    FeatureChains chains = curves_of(picture);
    double before = 0;
    for (const Vec2 p : corners) before = std::max(before, distance(chains, p, false));
    EXPECT_GT(before, 0.3);
    EXPECT_EQ(sharpen_corners(picture, chains), corners.size());
    for (const Vec2 p : corners) EXPECT_LT(distance(chains, p, true), 0.1) << p.x << ", " << p.y;
    EXPECT_EQ(find_defect(chains), std::nullopt);
  }
}

TEST(Corners, CurvesGoStraightToThem) {
  const std::vector<Vec2> corners = star({49.6, 45.2}, 35, 16, 4, 0.5);
  const image::Image picture = filled(corners);
  FeatureChains chains = curves_of(picture);
  sharpen_corners(picture, chains);
  ASSERT_EQ(chains.chains.size(), 1U);
  for (const ChainPoint& p : chains.chains[0].points) {
    double off = 1e9;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec2 along = corners[(i + 1) % corners.size()] - corners[i];
      const double t = std::clamp(dot(p.on_curve() - corners[i], along) / dot(along, along), 0.0, 1.0);
      off = std::min(off, norm(p.on_curve() - corners[i] - t * along));
    }
    EXPECT_LT(off, 0.15) << p.x << ", " << p.y;
  }
}

TEST(Corners, AcuteTipsLieBeyondTheirPixels) {
  const std::vector<Vec2> corners = star({49.6, 45.2}, 40, 14, 4, 0.5);
  const image::Image picture = filled(corners, 110, 100);
  FeatureChains chains = curves_of(picture);
  sharpen_corners(picture, chains);
  const auto& points = chains.chains.at(0).points;
  EXPECT_TRUE(
      std::any_of(points.begin(), points.end(), [](const ChainPoint& p) { return p.beyond != Vec2{}; }));
  EXPECT_EQ(find_defect(chains), std::nullopt) << "positions stay at their pixels";
}

TEST(Corners, RoundThingsHaveNone) {
  for (const double radius : {2.5, 3.0, 4.0, 6.0, 9.0, 12.0, 17.0, 30.0}) {
    for (const double shift : {0.0, 0.3, 0.5}) {
      const image::Image picture = testing::disc(80, 40 + shift, 40.2, radius);
      FeatureChains chains = curves_of(picture);
      EXPECT_EQ(sharpen_corners(picture, chains), 0U) << radius << ", " << shift;
    }
  }
}

TEST(Corners, RoundedOnesStayRound) {
  // Squares whose corners are round. Those of the smallest radius are between straight sides as near as those
  // of sharp ones: the picture tells.
  for (const double radius : {2.2, 3.0, 5.0}) {
    for (const Vec2 along : {Vec2{0.8, 0.6}, Vec2{1, 0}}) {
      const image::Image picture = draw(80, 80, [=](double x, double y) {
        const Vec2 p{x - 40, y - 40};
        const double u = std::max(0.0, std::abs(dot(along, p)) - 20 + radius);
        const double v = std::max(0.0, std::abs(cross(along, p)) - 20 + radius);
        return std::hypot(u, v) < radius ? 30.0 : 210.0;
      });
      FeatureChains chains = curves_of(picture);
      const auto before = chains.chains.at(0).points;
      EXPECT_EQ(sharpen_corners(picture, chains), 0U) << radius << ", " << along.x;
      for (std::size_t i = 0; i < before.size(); ++i)
        EXPECT_EQ(chains.chains[0].points[i].on_curve(), before[i].position);
    }
  }
}

TEST(Corners, NothingCrossesAfterwards) {
  std::size_t corners = 0;
  constexpr unsigned kPictures = knotreel::testing::rounds(40);
  for (unsigned seed = 1; seed <= kPictures; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(8, 92);
    constexpr double kReach = 16;
    std::vector<Vec2> centres;
    std::vector<std::vector<Vec2>> shapes;
    for (int i = 0; i < 12; ++i) {
      const Vec2 centre{place(random), place(random)};
      centres.push_back(centre);
      shapes.push_back(star(centre, kReach, 5, 3 + i % 3, place(random)));
    }
    const image::Image picture = draw(100, 100, [&](double x, double y) {
      double value = 250;
      for (std::size_t i = 0; i < shapes.size(); ++i) {
        const Vec2 p{x, y};
        if (norm(p - centres[i]) < kReach + 1 && inside(shapes[i], p)) value = 20.0 * double(i);
      }
      return value;
    });
    FeatureChains chains = curves_of(picture);
    corners += sharpen_corners(picture, chains);
    EXPECT_EQ(find_defect(chains), std::nullopt) << "seed " << seed;
    EXPECT_TRUE(crossing_steps(chains).empty()) << "seed " << seed;
  }
  EXPECT_GT(corners, std::size_t{10} * kPictures);
}

TEST(Corners, CurvesMeetWhereAreasDo) {
  const Vec2 meet{41.3, 38.6};
  // The upper half plane, turned, over two areas below.
  const image::Image picture = draw(80, 80, [&](double x, double y) {
    const Vec2 p = Vec2{x, y} - meet;
    if (p.y < 0.15 * p.x) return 30.0;
    return p.x < -0.2 * p.y ? 230.0 : 130.0;
  });
  FeatureChains chains = curves_of(picture);
  EXPECT_GT(distance(chains, meet, false), 0.12);
  ASSERT_EQ(sharpen_corners(picture, chains), 1U);
  EXPECT_LT(distance(chains, meet, true), 0.05);
  EXPECT_EQ(find_defect(chains), std::nullopt);
  int arms = 0;
  for (const Chain& chain : chains.chains) {
    for (const ChainPoint* end : {&chain.points.front(), &chain.points.back()}) {
      if (!end->corner) continue;
      ++arms;
      EXPECT_LT(norm(end->on_curve() - meet), 0.05);
    }
  }
  EXPECT_EQ(arms, 3);
}

TEST(Corners, StepsSayWhereBoxesEndOnly) {
  const auto hard = [](const std::vector<Vec2>& corners) {
    image::Image picture = filled(corners);
    for (float& s : picture.samples) s = s < 128 ? 40.0F : 230.0F;
    return picture;
  };
  const auto corners_of = [](const image::Image& picture, FeatureChains& chains) {
    chains = curves_of(picture);
    EXPECT_TRUE(chains.chains.at(0).stepped);
    return sharpen_corners(picture, chains);
  };
  FeatureChains chains;
  EXPECT_EQ(corners_of(hard(polygon({50.3, 44.8}, 30, 4, 0.4)), chains), 0U);
  const std::vector<Vec2> box{{20, 18}, {75, 18}, {75, 66}, {20, 66}};
  EXPECT_EQ(corners_of(hard(box), chains), 4U);
  for (const Vec2 p : box) EXPECT_LT(distance(chains, p, true), 0.02) << p.x << ", " << p.y;
}

TEST(Corners, BendsBelowTheLeastTurnAreLeft) {
  const std::vector<Vec2> corners = polygon({50, 45}, 38, 12, 0.1);  // turns of 30 degrees
  const image::Image picture = filled(corners);
  FeatureChains chains = curves_of(picture);
  EXPECT_EQ(sharpen_corners(picture, chains, {.least_turn = 35}), 0U);
  EXPECT_GT(sharpen_corners(picture, chains, {.least_turn = 25}), 6U);
}

TEST(Corners, MisuseIsRefused) {
  FeatureChains chains{20, 10, {}, 0};
  const image::Image picture = image::make_image(20, 10, 3);
  EXPECT_EQ(sharpen_corners(picture, chains), 0U);
  EXPECT_THROW(sharpen_corners(image::make_image(10, 20, 3), chains), Error);
  for (const double bad : {-1.0, 181.0, std::nan("")})
    EXPECT_THROW(sharpen_corners(picture, chains, {.least_turn = bad}), Error) << bad;
  for (const double bad : {0.0, -1.0, std::nan("")})
    EXPECT_THROW(sharpen_corners(picture, chains, {.most_error = bad}), Error) << bad;
}

TEST(KnownCorners, DoNotShow) {
  const auto same = [](const FeatureChains& a, const FeatureChains& b) {
    if (a.chains.size() != b.chains.size()) return false;
    for (std::size_t c = 0; c < a.chains.size(); ++c) {
      if (!std::ranges::equal(a.chains[c].points, b.chains[c].points, [](const auto& p, const auto& q) {
            return p.on_curve() == q.on_curve() && p.corner == q.corner;
          }))
        return false;
    }
    return true;
  };
  KnownCorners known;
  std::size_t size = 0;
  for (int i = 0; i < 6; ++i) {
    // The star stays for two pictures each.
    const image::Image picture = filled(star({48.6 + i / 2, 45.2}, 35, 16, 4, 0.5));
    FeatureChains with = curves_of(picture);
    FeatureChains without = with;
    EXPECT_EQ(sharpen_corners(picture, with, {}, &known), sharpen_corners(picture, without));
    EXPECT_TRUE(same(with, without));
    EXPECT_EQ(known.size() > size, i % 2 == 0) << "what is new";
    size = known.size();
  }
}

TEST(KnownCorners, TellPicturesApart) {
  KnownCorners known;
  for (const double ground : {230.0, 231.0, 120.0}) {  // the same curves, other colours
    const auto corners = star({49.6, 45.2}, 35, 16, 4, 0.5);
    const image::Image picture = draw(100, 90, [&](double x, double y) {
      return inside(corners, {x, y}) ? 40.0 : ground;
    });
    FeatureChains with = curves_of(filled(corners));
    FeatureChains without = with;
    const std::size_t before = known.size();
    EXPECT_EQ(sharpen_corners(picture, with, {}, &known), sharpen_corners(picture, without));
    EXPECT_GT(known.size(), before);
  }
}

TEST(KnownCorners, ForgetWhatNobodyAsksFor) {
  KnownCorners known;
  const image::Image first = filled(star({49.6, 45.2}, 35, 16, 4, 0.5));
  FeatureChains chains = curves_of(first);
  sharpen_corners(first, chains, {}, &known);
  EXPECT_GT(known.size(), 0U);
  const image::Image empty = draw(100, 90, [](double, double) { return 50.0; });
  for (int i = 0; i < 8; ++i) {
    chains = curves_of(empty);
    sharpen_corners(empty, chains, {}, &known);
  }
  EXPECT_EQ(known.size(), 0U);
}

}  // namespace
}  // namespace knotreel::features
