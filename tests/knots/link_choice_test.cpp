// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/link_choice.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "knotreel/spline/basis.h"
#include "knotreel/spline/link.h"
#include "knots/drawings.h"
#include "support/mesh_cases.h"

namespace knotreel::knots {
namespace {

constexpr std::uint64_t kLinkChoiceSeed = 20261124;
constexpr double kInvalid = std::numeric_limits<double>::infinity();

/// Sum of the errors of the triangles; kInvalid if one of them is flat or turned.
double error_of(const Target& target, const std::vector<Vec2>& polygon,
                const std::vector<spline::PolygonTriangle>& triangles) {
  double sum = 0;
  for (const auto& t : triangles) {
    const std::array<Vec2, 3> p{polygon[t[0]], polygon[t[1]], polygon[t[2]]};
    if (!(signed_area(p[0], p[1], p[2]) > 1e-6)) return kInvalid;
    sum += target.error(p);
  }
  return sum;
}

/// The least error of all triangulations of the corners i to j, one by one.
double least_error(const Target& target, const std::vector<Vec2>& polygon, std::size_t i, std::size_t j) {
  if (j - i < 2) return 0;
  double least = kInvalid;
  for (std::size_t k = i + 1; k < j; ++k) {
    const auto at = [](std::size_t v) { return static_cast<std::uint32_t>(v); };
    least = std::min(least, error_of(target, polygon, {{at(i), at(k), at(j)}}) +
                                least_error(target, polygon, i, k) + least_error(target, polygon, k, j));
  }
  return least;
}

struct Choice {
  std::vector<std::uint16_t> codes;
  std::vector<spline::PolygonTriangle> triangles;
};

Choice choose(const spline::LinkPolicy& policy, const std::vector<Vec2>& polygon) {
  const std::vector<mesh::CornerIndex> vertex{0};
  std::vector<mesh::CornerIndex> corners(polygon.size());
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<mesh::CornerIndex>(i + 1);
  Choice choice;
  policy({vertex, corners, polygon}, choice.codes);
  const auto used = spline::decode_triangulation(polygon.size(), choice.codes, choice.triangles);
  EXPECT_TRUE(used && *used == choice.codes.size());
  EXPECT_EQ(choice.triangles.size(), polygon.size() - 2);
  return choice;
}

/// Star-shaped, often not convex, in positive order.
std::vector<Vec2> random_polygon(std::size_t n, std::mt19937_64& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec2> polygon;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle =
        6.283185307179586 * (static_cast<double>(i) + 0.8 * unit(random)) / static_cast<double>(n);
    const double radius = 10 + 25 * unit(random);
    polygon.push_back({40 + radius * std::cos(angle), 40 + radius * std::sin(angle)});
  }
  return polygon;
}

TEST(PictureLinks, NoTriangulationIsBetter) {
  const Target target(testing::disc(80, 80, 3), {});
  const spline::LinkPolicy policy = picture_links(target);
  std::mt19937_64 random(kLinkChoiceSeed);
  int better_than_standard = 0;
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE("polygon " + std::to_string(i));
    const std::vector<Vec2> polygon = random_polygon(4 + std::size_t(i) % 4, random);
    const double least = least_error(target, polygon, 0, polygon.size() - 1);
    ASSERT_LT(least, kInvalid);
    const double chosen = error_of(target, polygon, choose(policy, polygon).triangles);
    EXPECT_NEAR(chosen, least, 1e-9 * (1 + least));
    const double standard = error_of(target, polygon, spline::triangulate_polygon(polygon));
    EXPECT_LE(chosen, standard * (1 + 1e-12));
    better_than_standard += chosen < 0.99 * standard;
  }
  EXPECT_GT(better_than_standard, 100) << "there must be something to choose";
}

TEST(PictureLinks, LargePolygonsAreTriangulatedInTheStandardWay) {
  const Target target(testing::disc(80, 80, 1), {});
  std::mt19937_64 random(kLinkChoiceSeed);
  for (const std::size_t n : {5U, 6U, 15U, 20U}) {
    const std::vector<Vec2> polygon = random_polygon(n, random);
    std::vector<std::uint16_t> standard;
    spline::encode_triangulation(n, spline::triangulate_polygon(polygon), standard);
    EXPECT_EQ(choose(picture_links(target, n - 1), polygon).codes, standard);
    if (n > 14) {
      EXPECT_EQ(choose(picture_links(target), polygon).codes, standard);
    }
  }
}

TEST(PictureLinks, PolygonsWithoutProperTriangulationsFallBack) {
  const Target target(testing::disc(80, 80, 1), {});
  const std::vector<Vec2> flat{{10, 10}, {20, 10}, {30, 10}, {40, 10}};
  std::vector<std::uint16_t> standard;
  spline::encode_triangulation(4, spline::triangulate_polygon(flat), standard);
  EXPECT_EQ(choose(picture_links(target), flat).codes, standard);
}

TEST(PictureLinks, MakeSpacesThatSumToOne) {
  for (const auto& c : knotreel::testing::corpus_cases()) {
    const Target target(testing::waves(static_cast<int>(c.mesh.width), static_cast<int>(c.mesh.height), 3),
                        {});
    const spline::LinkPolicy choice = picture_links(target);
    for (const int degree : {2, 3}) {
      SCOPED_TRACE(c.to_text());
      double standard = 0;
      double chosen = 0;
      const spline::LinkPolicy counting = [&](const spline::LinkPolygon& link,
                                              std::vector<std::uint16_t>& codes) {
        const std::vector<Vec2> polygon(link.positions.begin(), link.positions.end());
        const std::size_t before = codes.size();
        choice(link, codes);
        std::vector<spline::PolygonTriangle> triangles;
        EXPECT_TRUE(
            spline::decode_triangulation(polygon.size(), std::span(codes).subspan(before), triangles));
        const double s = error_of(target, polygon, spline::triangulate_polygon(polygon));
        if (s == kInvalid) return;
        standard += s;
        chosen += error_of(target, polygon, triangles);
      };
      const auto space = std::make_shared<const spline::SplineSpace>(c.mesh, degree, counting);
      EXPECT_LE(chosen, standard * (1 + 1e-12));
      const spline::Basis basis(space);
      std::vector<spline::BasisValue> values;
      for (const Vec2 u : knotreel::testing::probe_points(c.mesh, kLinkChoiceSeed, 20)) {
        basis.evaluate(u, values);
        double sum = 0;
        for (const auto& v : values) {
          sum += v.value;
          EXPECT_GE(v.value, -1e-9);
        }
        EXPECT_NEAR(sum, 1, 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace knotreel::knots
