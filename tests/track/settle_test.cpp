// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/settle.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace knotreel::track
