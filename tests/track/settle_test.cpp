// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/settle.h"

#include <gtest/gtest.h>

#include "knotreel/mesh/edge_lengths.h"
#include "support/mesh_cases.h"

namespace knotreel::track {
namespace {

/// A knot that is to gain nothing sleeps, and wakes again; where the picture rests it does not.
TEST(Settling, KnotsAtRestSleepOnOnceTheyHaveSettled) {
  const mesh::KnotMesh mesh = testing::random_cases(5, 1).front().mesh;
  const std::size_t count = mesh.knots.size();
  const std::vector<std::uint8_t> resting(count, 1);
  const std::vector<std::uint8_t> moving(count, 0);
  const std::vector<std::uint8_t> all(count, 1);
  Settling settling({.nap = 2});
  EXPECT_EQ(settling.awake(mesh, resting), all);
  EXPECT_EQ(settling.awake(mesh, moving, true), all);
  EXPECT_EQ(settling.awake(mesh, resting, true), moving) << "at once, none is";
  std::vector<Vec2> gradient(count, Vec2{100, 0});
  gradient[0] = {1e-6, 0};
  std::vector<Vec2> moves = settling.moves(mesh, gradient, 100);
  EXPECT_EQ(moves[0], Vec2{});
  std::vector<std::uint8_t> but_first = all;
  but_first[0] = 0;
  for (int nap = 0; nap < 2; ++nap) {
    EXPECT_EQ(settling.awake(mesh, moving), but_first);
    gradient[0] = {};
    settling.moves(mesh, gradient, 100);
  }
  EXPECT_EQ(settling.awake(mesh, moving), all);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(settling.awake(mesh, resting), but_first);
    settling.moves(mesh, gradient, 100);
  }
  // It is asked again where something happens, and then goes.
  gradient[0] = {100, 0};
  moves = settling.moves(mesh, gradient, 100);
  EXPECT_NE(moves[0], Vec2{});
  EXPECT_EQ(settling.awake(mesh, resting), all);
}

TEST(Settling, StepsGrowWhileTheDirectionStaysUpToABoundAndShrinkWhenItTurns) {
  const mesh::KnotMesh mesh = testing::random_cases(6, 1).front().mesh;
  const std::vector<double> shortest = mesh::shortest_edges(mesh);
  Settling settling({.first_step = 0.04, .least = 0, .least_gain = 0});
  // Of the shortest edge, the same for all knots.
  const auto share = [&](Vec2 gradient) {
    const std::vector<Vec2> moves = settling.moves(mesh, std::vector<Vec2>(shortest.size(), gradient), 1);
    for (std::size_t k = 0; k < moves.size(); ++k) {
      EXPECT_NEAR(norm(moves[k]) / shortest[k], norm(moves[0]) / shortest[0], 1e-9) << k;
      EXPECT_LT(dot(moves[k], gradient), 0) << k;
    }
    return norm(moves[0]) / shortest[0];
  };
  double before = share({1, 0});
  EXPECT_NEAR(before, 0.04, 1e-9);
  for (int i = 0; i < 3; ++i) {
    const double now = share({5, 0.1 * i});
    EXPECT_GT(now, before);
    before = now;
  }
  for (int i = 0; i < 8; ++i) before = share({1, 0});
  EXPECT_NEAR(before, share({1, 0}), 1e-9) << "they do not grow for ever";
  EXPECT_LE(before, 0.1 + 1e-9);
  EXPECT_NEAR(share({0, 1}), before, 1e-9) << "neither on nor back";
  const double back = share({0, -1});
  EXPECT_LT(back, before);
  EXPECT_LT(share({0, 1}), back);
}

}  // namespace
}  // namespace knotreel::track
