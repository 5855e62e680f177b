// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <queue>

#include "export/divide_for_paints.h"
#include "export/outlines.h"
#include "export_models.h"
#include "knotreel/base/error.h"

namespace knotreel::exporting {
namespace {

using namespace knotreel::testing;

constexpr const char* kCases[] = {"free-knots",  "two-tips",       "bend",           "three-fold-junction",
                                  "closed-loop", "loop-with-tail", "ends-on-border", "tip-inside-loop"};

document::FrameModel sample(const std::string& name, double reach = 1) {
  return picture_like_model(corpus_case(name).mesh, 2, 3, reach, 5);
}

Triangulation triangulated(const Tessellator& tessellator) {
  return triangulate(tessellator, 1'000'000, {});
}

double area(const Triangulation& t, std::uint32_t i) {
  return 0.5 * cross(t.x[t.triangles[i][1]] - t.x[t.triangles[i][0]],
                     t.x[t.triangles[i][2]] - t.x[t.triangles[i][0]]);
}

void expect_joined(const Triangulation& t) {
  std::size_t border = 0;
  for (std::uint32_t h = 0; h < t.opposite.size(); ++h) {
    const std::uint32_t o = t.opposite[h];
    if (o == kNoIndex) {
      ++border;
      continue;
    }
    ASSERT_EQ(t.opposite[o], h);
    ASSERT_EQ(t.vertex(o), t.target(h));
    ASSERT_EQ(t.target(o), t.vertex(h));
    ASSERT_EQ(t.piece[o] == kNoIndex, t.piece[h] == kNoIndex);
  }
  // Only the picture's four sides are open: as many edges end as begin at each of their vertices.
  EXPECT_GE(border, 4u);
  double total = 0;
  for (std::uint32_t i = 0; i < t.triangles.size(); ++i) total += area(t, i);
  EXPECT_NEAR(total, 8000, 1e-6);
}

TEST(Triangulation, JoinsTheFacesAndCoversThePicture) {
  for (const std::string name : kCases) {
    SCOPED_TRACE(name);
    const document::FrameModel model = sample(name, 0);
    expect_joined(triangulated(Tessellator(model)));
  }
}

TEST(Triangulation, TellsWhereFeaturesAre) {
  const document::FrameModel model = sample("closed-loop");
  const Tessellator tessellator(model);
  const Triangulation t = triangulated(tessellator);
  std::size_t pieces = 0;
  for (std::uint32_t h = 0; h < t.piece.size(); ++h) {
    if (t.piece[h] == kNoIndex) continue;
    ++pieces;
    const FeaturePiece& p = t.pieces[t.piece[h]];
    EXPECT_LT(p.t0, p.t1);
    EXPECT_LT(norm(tessellator.sheets().on_edge(p.half_edge, p.t0).x - t.origin(h)), 1e-9);
    EXPECT_LT(norm(tessellator.sheets().on_edge(p.half_edge, p.t1).x - t.x[t.target(h)]), 1e-9);
  }
  EXPECT_GT(pieces, 0u);
}

TEST(DivideForPaints, LeavesOnlyTrianglesThatPaintsFit) {
  document::FrameModel model = blank_model(corpus_case("free-knots").mesh, 2, 3);
  for (spline::FunctionIndex f = 0; f < model.space->function_count(); ++f) {
    const Vec2 g = model.space->greville(f);
    model.colour[3 * f] = 2.5 * g.x;  // channels that change in three directions
    model.colour[3 * f + 1] = 3 * g.y;
    model.colour[3 * f + 2] = g.x + g.y;
  }
  const Tessellator tessellator(model);
  Triangulation t = triangulated(tessellator);
  const std::size_t before = t.triangles.size();
  divide_for_paints(t, 3, 10, 1'000'000, {});
  EXPECT_GT(t.triangles.size(), before);
  expect_joined(t);
  for (std::uint32_t i = 0; i < t.triangles.size(); ++i) {
    std::array<Vec2, 3> x{};
    std::array<Rgb, 3> colour{};
    for (std::uint32_t k = 0; k < 3; ++k) {
      x[k] = t.origin(3 * i + k);
      for (std::size_t c = 0; c < 3; ++c) colour[k][c] = double{t.colour[3 * i + k][c]};
      EXPECT_NEAR(colour[k][0], 2.5 * x[k].x, 2.5);
    }
    const Paint paint = fit_paint(moments_of(x, colour)).paint;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(paint.at(x[k], c), colour[k][c], 10.001);
    }
  }
}

TEST(Regions, OneColourIsOneRegionAndALinearOneToo) {
  document::FrameModel model = blank_model(corpus_case("three-fold-junction").mesh, 2, 3);
  for (const double slope : {0.0, 1.5}) {
    for (spline::FunctionIndex f = 0; f < model.space->function_count(); ++f) {
      for (std::size_t c = 0; c < 3; ++c) model.colour[3 * f + c] = 50 + slope * model.space->greville(f).x;
    }
    const Tessellator tessellator(model);
    const Partition partition = merge_triangles(triangulated(tessellator), {});
    ASSERT_EQ(partition.regions.size(), 1u);
    EXPECT_EQ(partition.regions[0].flat, slope == 0);
    EXPECT_NEAR(partition.regions[0].area, 8000, 1e-6);
    EXPECT_NEAR(partition.regions[0].paint.at({80, 30}, 1), 50 + slope * 80, 0.1);
  }
}

TEST(Regions, HangTogetherAndKeepTheTolerance) {
  for (const std::string name : kCases) {
    SCOPED_TRACE(name);
    const document::FrameModel model = sample(name);
    const Tessellator tessellator(model);
    Triangulation t = triangulated(tessellator);
    divide_for_paints(t, 3, 6, 1'000'000, {});
    RegionOptions options;
    options.colour_tolerance = 6;
    options.hidden = 0;
    const Partition partition = merge_triangles(t, options);
    ASSERT_LT(partition.regions.size(), t.triangles.size() / 4);
    std::vector<int> members(partition.regions.size());
    for (const std::uint32_t r : partition.region_of) ++members[r];
    for (std::uint32_t h = 0; h < t.colour.size(); ++h) {
      const std::uint32_t r = partition.region_of[h / 3];
      if (members[r] == 1) continue;  // triangles of less than a pixel may be off
      const Paint& paint = partition.regions[r].paint;
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(paint.at(t.origin(h), c), double{t.colour[h][c]}, 6.01);
    }
    std::vector<bool> seen(t.triangles.size());
    std::vector<int> parts(partition.regions.size());
    for (std::uint32_t i = 0; i < seen.size(); ++i) {
      if (seen[i]) continue;
      ++parts[partition.region_of[i]];
      std::queue<std::uint32_t> open({i});
      seen[i] = true;
      while (!open.empty()) {
        const std::uint32_t j = open.front();
        open.pop();
        for (std::uint32_t h = 3 * j; h < 3 * j + 3; ++h) {
          if (t.opposite[h] == kNoIndex) continue;
          const std::uint32_t k = t.opposite[h] / 3;
          if (seen[k] || partition.region_of[k] != partition.region_of[i]) continue;
          seen[k] = true;
          open.push(k);
        }
      }
    }
    for (const int n : parts) EXPECT_EQ(n, 1);
  }
}

TEST(Regions, WhatCannotBeSeenGoesToANeighbour) {
  const document::FrameModel model = sample("two-tips");
  const Tessellator tessellator(model);
  const Triangulation t = triangulated(tessellator);
  RegionOptions options;
  options.hidden = 0;
  const std::size_t all = merge_triangles(t, options).regions.size();
  options.hidden = 8;
  const std::size_t fewer = merge_triangles(t, options).regions.size();
  options.hidden = 1e9;
  EXPECT_LT(fewer, all);
  EXPECT_EQ(merge_triangles(t, options).regions.size(), 1u);
}

/// Area to the left of a closed chain of curves, by chords.
double enclosed(const Loop& outline) {
  double sum = 0;
  for (const Curve& c : outline) {
    Vec2 from = c[0];
    for (int i = 1; i <= 64; ++i) {
      const double t = i / 64.0;
      const double s = 1 - t;
      const Vec2 to =
          (s * s * s) * c[0] + (3 * s * s * t) * c[1] + (3 * s * t * t) * c[2] + (t * t * t) * c[3];
      sum += 0.5 * cross(from, to);
      from = to;
    }
  }
  return sum;
}

TEST(Outlines, AreClosedAndEncloseTheirRegions) {
  for (const std::string name : kCases) {
    SCOPED_TRACE(name);
    const document::FrameModel model = sample(name);
    const Tessellator tessellator(model);
    const Triangulation t = triangulated(tessellator);
    const Partition partition = merge_triangles(t, {});
    constexpr double kTolerance = 0.05;
    const auto all = outlines(tessellator, t, partition, {kTolerance, 0, 3});
    ASSERT_EQ(all.size(), partition.regions.size());
    double total = 0;
    for (std::size_t r = 0; r < all.size(); ++r) {
      double inside = 0;
      double length = 0;
      for (const Loop& outline : all[r]) {
        EXPECT_EQ(outline.back()[3], outline.front()[0]);
        for (std::size_t i = 0; i + 1 < outline.size(); ++i) EXPECT_EQ(outline[i][3], outline[i + 1][0]);
        for (const Curve& c : outline) length += norm(c[3] - c[0]);
        inside += enclosed(outline);
      }
      // Triangles have chords where outlines have the curve of the feature, and either may be off.
      EXPECT_NEAR(inside, partition.regions[r].area, 0.1 + 3 * kTolerance * length);
      total += inside;
    }
    // What one loses is its neighbour's, to the bit but for rounding of the sum.
    double border = 0;
    for (std::uint32_t h = 0; h < t.opposite.size(); ++h) {
      if (t.opposite[h] == kNoIndex) border += 0.5 * cross(t.origin(h), t.x[t.target(h)]);
    }
    EXPECT_NEAR(total, border, 1 + 400 * kTolerance);
  }
}

TEST(Outlines, OfAnIslandLeaveAHole) {
  const document::FrameModel model = sample("closed-loop");
  const Tessellator tessellator(model);
  const Triangulation t = triangulated(tessellator);
  // Everything that can be reached from the first triangle, which is at the border, without crossing the
  // loop.
  Partition partition;
  partition.regions.resize(2);
  partition.region_of.assign(t.triangles.size(), 1);
  std::queue<std::uint32_t> open({0});
  partition.region_of[0] = 0;
  while (!open.empty()) {
    const std::uint32_t i = open.front();
    open.pop();
    for (std::uint32_t h = 3 * i; h < 3 * i + 3; ++h) {
      if (t.opposite[h] == kNoIndex || t.piece[h] != kNoIndex) continue;
      std::uint32_t& region = partition.region_of[t.opposite[h] / 3];
      if (region == 0) continue;
      region = 0;
      open.push(t.opposite[h] / 3);
    }
  }
  const auto all = outlines(tessellator, t, partition, {0.05, 0, 3});
  const std::size_t island = all[0].size() == 1 ? 0 : 1;
  ASSERT_EQ(all[island].size(), 1u);
  ASSERT_EQ(all[1 - island].size(), 2u);
  const double hole = std::min(enclosed(all[1 - island][0]), enclosed(all[1 - island][1]));
  EXPECT_LT(hole, 0);
  EXPECT_NEAR(enclosed(all[island][0]), -hole, 1e-9);
  // The loop is smooth but for the knots that bend it: curves, and few of them.
  EXPECT_FALSE(std::all_of(all[island][0].begin(), all[island][0].end(), is_straight));
}

/// Borders between nearly equal paints may be loose, those that can be seen may not.
TEST(Outlines, AreSimplerWhereTheirPaintsAreAlike) {
  const document::FrameModel model = sample("two-tips");
  const Tessellator tessellator(model);
  const Triangulation t = triangulated(tessellator);
  Partition partition = merge_triangles(t, {});
  const auto curves = [&](double hidden) {
    std::size_t count = 0;
    for (const auto& loops : outlines(tessellator, t, partition, {0.05, hidden, 3})) {
      for (const Loop& loop : loops) count += loop.size();
    }
    return count;
  };
  const std::size_t exact = curves(0);
  EXPECT_LT(curves(6), exact - exact / 20);
  for (std::size_t r = 0; r < partition.regions.size(); ++r) {
    const auto level = static_cast<double>(r * 97 % 251);
    partition.regions[r].paint = {{level, level, level}, {}, {}, {1, 0}};
  }
  EXPECT_GT(curves(6), exact - exact / 50);
}

TEST(Triangulation, RefusesMoreThanAllowed) {
  const document::FrameModel model = sample("bend");
  EXPECT_THROW(triangulate(Tessellator(model), 10, {}), Error);
}

}  // namespace
}  // namespace knotreel::exporting
