// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/knot_motion.h"

#include <gtest/gtest.h>

#include <memory>

#include "knotreel/motion/warp.h"
#include "motion/scenes.h"
#include "support/mesh_cases.h"

namespace knotreel::track {
namespace {

constexpr int kKnotMotionWidth = 160;
constexpr int kKnotMotionHeight = 120;

bool in_hole(Vec2 p) {
  return p.x > 50 && p.x < 110 && p.y > 40 && p.y < 90;
}

template <typename Value>
motion::Luma drawn(const Value& value) {
  return motion::luma_of(motion::testing::draw(kKnotMotionWidth, kKnotMotionHeight, value));
}

/// A texture with a hole in which there is nothing to be seen, moved by d.
motion::Luma texture_with_a_hole(Vec2 d) {
  const motion::testing::Texture texture;
  return drawn([&](Vec2 p) { return in_hole(p - d) ? 120.0 : texture(p - d); });
}

/// A texture, moved by d, behind another one that does not move.
motion::Luma texture_behind_a_window(Vec2 d) {
  const motion::testing::Texture texture;
  const motion::testing::Texture window(2);
  return drawn([&](Vec2 p) { return in_hole(p) ? window(p) : texture(p - d); });
}

/// From the scene to the scene moved by d, with a flow that somebody tells.
template <typename FlowAt>
Motion motion_by(Vec2 d, const FlowAt& flow_at, motion::Luma (*scene)(Vec2) = texture_with_a_hole) {
  Motion motion;
  motion.before = std::make_shared<motion::Luma>(scene({}));
  motion.now = std::make_shared<motion::Luma>(scene(d));
  motion.flow.forward = motion::testing::constant_flow(kKnotMotionWidth, kKnotMotionHeight, {});
  for (int y = 0; y < kKnotMotionHeight; ++y) {
    for (int x = 0; x < kKnotMotionWidth; ++x) {
      const Vec2 flow = flow_at(Vec2{x + 0.5, y + 0.5});
      const auto i = static_cast<std::size_t>(y * kKnotMotionWidth + x);
      motion.flow.forward.xy[2 * i] = static_cast<float>(flow.x);
      motion.flow.forward.xy[2 * i + 1] = static_cast<float>(flow.y);
    }
  }
  motion.flow.consistent.assign(static_cast<std::size_t>(kKnotMotionWidth) * kKnotMotionHeight, 1);
  motion.moved = std::make_shared<motion::Luma>(motion::warp(*motion.now, motion.flow.forward));
  return motion;
}

struct Knots {
  mesh::KnotMesh mesh = [] {
    knotreel::testing::MeshBuilder builder(kKnotMotionWidth, kKnotMotionHeight);
    for (int y = 8; y < kKnotMotionHeight; y += 8) {
      for (int x = 8; x < kKnotMotionWidth; x += 8) builder.free(x + 0.3 * (y % 3), y);
    }
    return builder.triangulated();
  }();
  std::vector<Vec2> points = [this] {
    std::vector<Vec2> result;
    for (const mesh::Knot& k : mesh.knots) result.push_back(k.position);
    return result;
  }();

  /// Calls check with the motion of each knot well inside the hole, or of each well outside.
  template <typename Check>
  void check(bool inside, const std::vector<Vec2>& moves, const Check& check) const {
    std::size_t count = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const Vec2 p = points[k];
      const bool deep = p.x > 58 && p.x < 102 && p.y > 48 && p.y < 82;
      const bool outside = (p.x < 40 || p.x > 120) && p.x > 16 && p.x < 144 && p.y > 16 && p.y < 104;
      if (!(inside ? deep : outside)) continue;
      check(moves[k]);
      ++count;
    }
    EXPECT_GT(count, 10U);
  }
};

TEST(KnotMotion, WhereNothingIsToBeSeenKnotsGoWithTheOthers) {
  const Knots knots;
  const Vec2 d{6, 2};
  const auto moves = knot_motion(knots.mesh, knots.points, motion_by(d, [&](Vec2) { return d; }));
  knots.check(true, moves, [&](Vec2 m) { EXPECT_EQ(m, d); });
  knots.check(false, moves, [&](Vec2 m) { EXPECT_LT(norm(m - d), 0.3); });
}

TEST(KnotMotion, WhereNothingIsToBeSeenAndNothingMovesKnotsStay) {
  const Knots knots;
  const auto flow = [](Vec2 p) { return in_hole(p) ? Vec2{6, 2} : Vec2{}; };
  const auto moves = knot_motion(knots.mesh, knots.points, motion_by({}, flow));
  knots.check(true, moves, [](Vec2 m) { EXPECT_EQ(m, Vec2{}); });
  knots.check(false, moves, [](Vec2 m) { EXPECT_EQ(m, Vec2{}); });
}

TEST(KnotMotion, WhereNothingIsToBeSeenKnotsStayWhenTheOthersHardlyMove) {
  const Knots knots;
  const Vec2 d{0.8, 0.4};
  const auto moves = knot_motion(knots.mesh, knots.points, motion_by(d, [&](Vec2) { return d; }));
  knots.check(true, moves, [](Vec2 m) { EXPECT_EQ(m, Vec2{}); });
  knots.check(false, moves, [&](Vec2 m) { EXPECT_LT(norm(m - d), 0.3); });
}

TEST(KnotMotion, WhatIsSeenToStayStays) {
  const Knots knots;
  const Vec2 d{6, 2};
  const Motion motion = motion_by(
      d, [&](Vec2) { return d; }, texture_behind_a_window);
  const auto moves = knot_motion(knots.mesh, knots.points, motion);
  knots.check(true, moves, [](Vec2 m) { EXPECT_EQ(m, Vec2{}); });
  knots.check(false, moves, [&](Vec2 m) { EXPECT_LT(norm(m - d), 0.3); });
}

}  // namespace
}  // namespace knotreel::track
