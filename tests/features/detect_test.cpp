// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/detect.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "features/chain_defects.h"
#include "features/drawings.h"
#include "knotreel/base/error.h"
#include "knotreel/features/fair.h"
#include "support/pictures.h"

namespace knotreel::features {
namespace {

using testing::arms_of_nodes;
using testing::convex_polygon;
using testing::disc;
using testing::draw;
using testing::point_count;
using testing::turned;

image::Image vertical_step(int width, int height, int column, double left, double right) {
  return draw(width, height, [=](double x, double) { return x < column ? left : right; });
}

TEST(Detect, AHardStepIsExact) {
  for (const double right : {90.0, 255.0}) {
    for (const int column : {6, 7, 10, 20}) {
      const image::Image image = vertical_step(32, 40, column, right == 90 ? 255 : 0, right);
      const FeatureChains chains = detect_features(image);
      ASSERT_EQ(chains.chains.size(), 1U);
      EXPECT_EQ(chains.chains[0].points.size(), 40U) << "from the top to the bottom";
      EXPECT_TRUE(chains.chains[0].first_on_border && chains.chains[0].last_on_border);
      for (const ChainPoint& p : chains.chains[0].points) {
        EXPECT_EQ(p.position.x, column);
        EXPECT_EQ(p.position.y, p.y + 0.5);
      }
      const FeatureChains lying = detect_features(turned(image, testing::Turn::kTranspose));
      ASSERT_EQ(lying.chains.size(), 1U);
      for (const ChainPoint& p : lying.chains[0].points)
        EXPECT_EQ(p.position, (Vec2{p.x + 0.5, double(column)}));
    }
  }
}

TEST(Detect, EveryChannelCounts) {
  const image::Image step = vertical_step(32, 32, 16, 20, 200);
  for (const int channels : {1, 2, 3, 4}) {
    for (int c = 0; c < channels; ++c) {
      image::Image image = image::make_image(32, 32, channels);
      for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 32; ++x) {
          if (image.has_alpha()) image.at(x, y, channels - 1) = 255;
          image.at(x, y, c) = step.at(x, y, 0);
        }
      }
      const FeatureChains chains = detect_features(image);
      ASSERT_EQ(chains.chains.size(), 1U) << c << " of " << channels;
      for (const ChainPoint& p : chains.chains[0].points) EXPECT_EQ(p.position.x, 16);
    }
  }
}

TEST(Detect, ChannelsThatChangeInOppositeWaysAreOneEdge) {
  // Red falls by what green rises, a little more in every other row: the strongest channel is now this, now
  // that.
  image::Image image = image::make_image(32, 60, 3);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 32; ++x) {
      image.at(x, y, 0) = x < 16 ? 200.0F + float(y % 2) : 100;
      image.at(x, y, 1) = x < 16 ? 100.0F : 201 - float(y % 2);
    }
  }
  const FeatureChains chains = detect_features(image);
  ASSERT_EQ(chains.chains.size(), 1U);
  EXPECT_GE(chains.chains[0].points.size(), 60U);
  EXPECT_LE(chains.chains[0].points.size(), 62U);
}

TEST(Detect, WhatIsInvisibleHasNoEdges) {
  image::Image image = test::random_8bit_picture(40, 40, 4, 1);
  for (std::size_t i = 3; i < image.samples.size(); i += 4) image.samples[i] = 0;
  EXPECT_TRUE(detect_features(image).chains.empty());
  // Nor does it move those of what is visible.
  for (int y = 0; y < 40; ++y) {
    for (int x = 20; x < 40; ++x) {
      image.at(x, y, 0) = 230;
      image.at(x, y, 1) = image.at(x, y, 2) = 60;
      image.at(x, y, 3) = 225;
    }
  }
  const FeatureChains chains = detect_features(image);
  ASSERT_EQ(chains.chains.size(), 1U);
  for (const ChainPoint& p : chains.chains[0].points) EXPECT_EQ(p.position.x, 20);
}

TEST(Detect, ColoursCountByTheirAlphaInTheirPlacesToo) {
  // Alpha changes little, but with it a colour that is strong on one side and hidden on the other.
  image::Image image = test::random_8bit_picture(40, 40, 4, 2);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      image.at(x, y, 3) = x < 20 ? 0 : 100;
      for (int c = 0; c < 3; ++c) {
        if (x >= 20) image.at(x, y, c) = 255;
      }
    }
  }
  const FeatureChains chains = detect_features(image);
  ASSERT_EQ(chains.chains.size(), 1U);
  for (const ChainPoint& p : chains.chains[0].points) EXPECT_EQ(p.position.x, 20);
}

TEST(Detect, TheTwoSidesOfAThinLineAreItsWidthApart) {
  for (const int width : {1, 2, 3, 5}) {
    const image::Image image =
        draw(40, 40, [=](double x, double) { return x >= 17 && x < 17 + width ? 250.0 : 40.0; });
    const FeatureChains chains = detect_features(image);
    ASSERT_EQ(chains.chains.size(), 2U) << width;
    std::vector<double> places;
    for (const Chain& chain : chains.chains) {
      places.push_back(chain.points[20].position.x);
      for (const ChainPoint& p : chain.points) EXPECT_EQ(p.position.x, places.back());
    }
    std::sort(places.begin(), places.end());
    EXPECT_EQ(places[0], 17);
    EXPECT_EQ(places[1], 17 + width);
  }
}

TEST(Detect, AntialiasedStraightEdgesAreFoundAtAnyAngle) {
  for (const double angle : {0.1, 0.4, 0.7, 0.77, 0.8, 1.0, 1.3, 1.8, 2.2, 2.9}) {
    const Vec2 normal{std::cos(angle), std::sin(angle)};
    const auto distance = [&](double x, double y) { return dot(normal, Vec2{x - 31.7, y - 25.2}); };
    FeatureChains chains =
        detect_features(draw(64, 64, [&](double x, double y) { return distance(x, y) < 0 ? 40.0 : 210.0; }));
    ASSERT_EQ(chains.chains.size(), 1U) << angle;
    EXPECT_TRUE(chains.chains[0].first_on_border && chains.chains[0].last_on_border) << angle;
    const auto& points = chains.chains[0].points;
    for (std::size_t i = 1; i < points.size(); ++i) {
      EXPECT_GT(norm(points[i].position - points[i - 1].position), 0.6) << "points do not crowd, " << angle;
    }
    for (const ChainPoint& p : points) {
      const bool inside = p.x > 2 && p.y > 2 && p.x < 61 && p.y < 61;
      if (inside) {
        EXPECT_LT(std::abs(distance(p.position.x, p.position.y)), 0.12) << angle;
      }
    }
  }
}

TEST(Detect, DiscsAreOneClosedCurveNearTheCircle) {
  for (const double radius : {4.0, 6.5, 10.0, 20.0}) {
    for (const double shift : {0.0, 0.25, 0.5}) {
      const Vec2 centre{32 + shift, 31.5 + 0.5 * shift};
      FeatureChains chains = detect_features(disc(64, centre.x, centre.y, radius));
      ASSERT_EQ(chains.chains.size(), 1U) << radius;
      EXPECT_TRUE(chains.chains[0].closed);
      fair_chains(chains);
      double worst = 0;
      for (const ChainPoint& p : chains.chains[0].points) {
        worst = std::max(worst, std::abs(norm(p.position - centre) - radius));
      }
      EXPECT_LT(worst, radius < 5 ? 0.2 : 0.12) << radius << " " << shift;
    }
  }
}

TEST(Detect, PolygonsAreClosedAndCornersStayNear) {
  const std::vector<std::vector<Vec2>> shapes = {
      {{20, 20}, {50, 20}, {50, 50}, {20, 50}},
      {{20.4, 17.7}, {50.3, 22.2}, {44, 50.6}},
      {{32, 10}, {54, 32}, {32, 54}, {10, 32}},
      {{14, 22}, {48, 12}, {58, 36}, {36, 56}, {12, 44}},
  };
  for (const auto& corners : shapes) {
    FeatureChains chains = detect_features(convex_polygon(64, 64, corners));
    ASSERT_EQ(chains.chains.size(), 1U);
    EXPECT_TRUE(chains.chains[0].closed);
    fair_chains(chains);
    for (const Vec2 corner : corners) {
      double nearest = 100;
      for (const ChainPoint& p : chains.chains[0].points)
        nearest = std::min(nearest, norm(p.position - corner));
      EXPECT_LT(nearest, 1.7) << corner.x << " " << corner.y;
    }
  }
}

TEST(Detect, ThreeAreasMeetInAJunction) {
  const auto image = draw(60, 60, [](double x, double y) {
    return x < 30 ? 20.0 : y < 30.3 ? 120.0 : 230.0;
  });
  const FeatureChains chains = detect_features(image);
  EXPECT_EQ(chains.chains.size(), 3U);
  int junctions = 0;
  for (const auto& [node, arms] : arms_of_nodes(chains)) junctions += arms == 3 ? 1 : 0;
  EXPECT_EQ(junctions, 1);
  for (const Chain& chain : chains.chains) EXPECT_TRUE(chain.first_on_border || chain.last_on_border);
}

TEST(Detect, FourAreasMeetInOneJunctionOrTwo) {
  const auto image = draw(
      60, 60, [](double x, double y) { return x < 30 ? (y < 30 ? 20.0 : 150.0) : (y < 30 ? 90.0 : 240.0); });
  const FeatureChains chains = detect_features(image);
  EXPECT_FALSE(find_defect(chains));
  int ends_at_sides = 0;
  int tips = 0;
  for (const auto& [node, arms] : arms_of_nodes(chains)) tips += arms == 1 ? 1 : 0;
  for (const Chain& chain : chains.chains) ends_at_sides += chain.first_on_border + chain.last_on_border;
  EXPECT_EQ(ends_at_sides, 4);
  EXPECT_EQ(tips, 4) << "only those at the sides";
}

TEST(Detect, SoftEdgesAreLeftToTheSpline) {
  const auto ramp = [](double width) {
    return draw(64, 64,
                [=](double x, double) { return 40 + 180 * std::clamp((x - 32) / width + 0.5, 0.0, 1.0); });
  };
  EXPECT_EQ(detect_features(ramp(1)).chains.size(), 1U);
  EXPECT_EQ(detect_features(ramp(2)).chains.size(), 1U);
  EXPECT_EQ(detect_features(ramp(5)).chains.size(), 0U);
  DetectOptions off;
  off.max_blur = 0;
  EXPECT_EQ(detect_features(ramp(5), off).chains.size(), 1U);
  DetectOptions wide;
  wide.max_blur = 6;
  EXPECT_EQ(detect_features(ramp(5), wide).chains.size(), 1U);
}

TEST(Detect, SoftnessIsMeasuredAcrossTheEdge) {
  const auto image = draw(64, 64, [](double x, double y) {
    return 40 + 180 * std::clamp((x + y - 70.3) / std::sqrt(2) / 2.6 + 0.5, 0.0, 1.0);
  });
  EXPECT_EQ(detect_features(image).chains.size(), 1U) << "2.6 px wide, but 3.7 px along rows and columns";
}

TEST(Detect, FramesAreTwoClosedCurves) {
  for (const double stroke : {3.0, 3.5, 4.0, 5.0, 6.5}) {
    for (const double turn : {0.0, 0.2, 0.5}) {
      for (const double inner : {3.0, 5.0, 8.0}) {
        const auto image = draw(60, 60, [=](double x, double y) {
          const double u = std::cos(turn) * (x - 30.2) + std::sin(turn) * (y - 29.6);
          const double v = std::cos(turn) * (y - 29.6) - std::sin(turn) * (x - 30.2);
          const double r = std::max(std::abs(u), std::abs(v));
          return r > inner && r < inner + stroke ? 240.0 : 20.0;
        });
        const FeatureChains chains = detect_features(image);
        EXPECT_EQ(chains.chains.size(), 2U) << stroke << " " << turn << " " << inner;
        for (const Chain& chain : chains.chains) EXPECT_TRUE(chain.closed);
      }
    }
  }
}

TEST(Detect, OnlyTheHardPartOfAnEdgeIsAFeature) {
  // Hard in the upper half, a ramp of 7 px in the lower.
  const auto image = draw(64, 100, [](double x, double y) {
    const double width = y < 50 ? 0.01 : 7;
    return 40 + 180 * std::clamp((x - 32) / width + 0.5, 0.0, 1.0);
  });
  const FeatureChains chains = detect_features(image);
  ASSERT_EQ(chains.chains.size(), 1U);
  for (const ChainPoint& p : chains.chains[0].points) EXPECT_LT(p.y, 56);
  EXPECT_GT(chains.chains[0].points.size(), 44U);
}

TEST(Detect, WeakAndShortEdgesAreDropped) {
  const auto count = [](const image::Image& image, const DetectOptions& options) {
    return detect_features(image, options).chains.size();
  };
  DetectOptions options;
  const auto faint = vertical_step(40, 100, 20, 100, 125);  // smoothed gradient 7.8
  EXPECT_EQ(count(faint, options), 0U);
  options.anchor_threshold = 6;
  EXPECT_EQ(count(faint, options), 1U);
  options.edge_threshold = 9;
  EXPECT_EQ(count(faint, options), 0U);

  const auto spot = disc(40, 20, 20, 4);
  EXPECT_EQ(count(spot, {}), 1U);
  DetectOptions long_only;
  long_only.min_length = 40;
  EXPECT_EQ(count(spot, long_only), 0U);
  DetectOptions heavy_only;
  heavy_only.min_weight = 3000;
  EXPECT_EQ(count(spot, heavy_only), 0U);
}

TEST(Detect, HysteresisKeepsTheFaintEndOfAChain) {
  const auto image = draw(40, 100, [](double x, double y) { return x < 20 ? 100.0 : 120 + 0.8 * y; });
  const FeatureChains chains = detect_features(image);
  ASSERT_EQ(chains.chains.size(), 1U);
  EXPECT_GT(chains.chains[0].points.size(), 95U) << "the upper end alone is below the anchor threshold";
}

TEST(Detect, TheMagnitudeIsAChoice) {
  const auto image = convex_polygon(64, 64, {{20.4, 17.7}, {50.3, 22.2}, {44, 50.6}});
  DetectOptions euclidean;
  euclidean.euclidean_magnitude = true;
  const auto usual = testing::pixels_of(detect_features(image));
  const auto original = testing::pixels_of(detect_features(image, euclidean));
  EXPECT_NE(usual, original);
}

TEST(Detect, NothingInNothing) {
  for (const auto& [width, height] :
       {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 2}, {3, 3}, {2, 50}, {4, 4}, {5, 5}}) {
    EXPECT_TRUE(detect_features(test::random_picture(width, height, 3, 1)).chains.empty());
  }
  const FeatureChains chains = detect_features(draw(50, 40, [](double, double) { return 77.7; }));
  EXPECT_TRUE(chains.chains.empty());
  EXPECT_EQ(chains.width, 50);
  EXPECT_EQ(chains.height, 40);
  EXPECT_EQ(chains.node_count, 0U);
}

TEST(Detect, WrongOptionsAreRefused) {
  const image::Image image = image::make_image(8, 8, 1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](auto change) {
    DetectOptions options;
    change(options);
    EXPECT_THROW(detect_features(image, options), Error);
  };
  for (const double bad : {-1.0, nan}) {
    refused([=](DetectOptions& o) { o.smoothing = bad; });
    refused([=](DetectOptions& o) { o.edge_threshold = bad; });
    refused([=](DetectOptions& o) { o.anchor_threshold = bad; });
    refused([=](DetectOptions& o) { o.min_length = bad; });
    refused([=](DetectOptions& o) { o.min_weight = bad; });
    refused([=](DetectOptions& o) { o.max_blur = bad; });
  }
  refused([](DetectOptions& o) { o.edge_threshold = 0; });
  refused([](DetectOptions& o) { o.smoothing = 11; });
  EXPECT_THROW(detect_features(image::Image{4, 4, 1, {}}), Error);
}

}  // namespace
}  // namespace knotreel::features
