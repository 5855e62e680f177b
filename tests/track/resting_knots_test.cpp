// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/resting_knots.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/mesh_cases.h"

namespace knotreel::track {
namespace {

constexpr int kFramesToRest = 2;
constexpr double kAside = 3;  // pixels: surfaces are displaced

/// At rest but for one cell.
motion::Rest rest_but_at(int width, int height, int x, int y) {
  motion::Rest rest(kFramesToRest);
  rest.start(width, height);
  const auto columns = static_cast<std::size_t>((width + 7) / 8);
  std::vector<std::uint8_t> unchanged(columns * static_cast<std::size_t>((height + 7) / 8), 1);
  unchanged[static_cast<std::size_t>(y / 8) * columns + static_cast<std::size_t>(x / 8)] = 0;
  for (int i = 0; i < kFramesToRest; ++i) rest.add(unchanged);
  return rest;
}

TEST(RestingKnots, HaveNoFaceNearWhatChanges) {
  std::size_t resting = 0;
  for (const auto& c : testing::random_cases(3, 20)) {
    const int width = static_cast<int>(c.mesh.width);
    const int height = static_cast<int>(c.mesh.height);
    const motion::Rest rest = rest_but_at(width, height, width / 2, height / 2);
    const std::vector<std::uint8_t> rests = resting_knots(c.mesh, rest);
    const Vec2 changed{width / 2 / 8 * 8.0, height / 2 / 8 * 8.0};
    for (const mesh::Face& face : c.mesh.faces) {
      Vec2 low{1e9, 1e9};
      Vec2 high{-1e9, -1e9};
      for (const mesh::KnotIndex k : face) {
        const Vec2 p = c.mesh.knots[k].position;
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
      }
      if (high.x + kAside < changed.x || low.x - kAside > changed.x + 8 || high.y + kAside < changed.y ||
          low.y - kAside > changed.y + 8)
        continue;
      for (const mesh::KnotIndex k : face) EXPECT_FALSE(rests[k]) << c.name;
    }
    resting += static_cast<std::size_t>(std::count(rests.begin(), rests.end(), 1));
  }
  EXPECT_GT(resting, 0u);
}

TEST(RestingKnots, GeometryRestsWithAllOfItsKnots) {
  for (const auto& c : testing::random_cases(4, 10)) {
    const spline::SplineSpace space(c.mesh, 2);
    std::vector<std::uint8_t> resting(c.mesh.knots.size(), 1);
    resting[c.mesh.knots.size() / 2] = 0;
    const std::vector<std::uint8_t> geometry = resting_geometry(space, resting);
    for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
      const bool has_it = std::ranges::any_of(space.functions()[f].knots, [&](mesh::CornerIndex corner) {
        return corner != spline::kNoCorner && !resting[space.cut().corners[corner].knot];
      });
      EXPECT_EQ(geometry[space.geometry_of()[f]], has_it ? 0 : 1) << c.name;
    }
  }
}

}  // namespace
}  // namespace knotreel::track
