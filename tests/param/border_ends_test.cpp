// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "knotreel/param/parametrization.h"
#include "param/framed_mesh.h"
#include "param/laws.h"
#include "support/chains.h"

namespace knotreel::param {
namespace {

using knotreel::testing::ChainBuilder;
using testing::run_sound;

TEST(BorderEnds, EndsOnTheBorderAreContinuedToIt) {
  ChainBuilder b(80, 60);
  ASSERT_TRUE(b.add({{0.5, 20.5}, {79.5, 35.5}}));
  const Parametrization p = run_sound(b.chains);
  EXPECT_EQ(p.vertices.front().place, VertexPlace::kLeft);
  EXPECT_EQ(p.vertices.back().place, VertexPlace::kRight);
  EXPECT_EQ(p.curve_samples.front().pixel, kNoPixel);
  EXPECT_EQ(p.curve_samples.back().pixel, kNoPixel);
  EXPECT_EQ(p.curve_samples.size(), b.chains.chains[0].points.size() + 2);
}

TEST(BorderEnds, TheRingOfTheMeshFollowsEndsOnTheBorder) {
  ChainBuilder b(80, 60);
  ASSERT_TRUE(b.add({{0.5, 20.5}, {30.5, 50.5}}));
  const auto mesh = features::make_image_mesh(b.chains);
  const Parametrization p = run_sound(b.chains);
  const FramedMesh framed(mesh, p);
  EXPECT_EQ(framed.vertex(p.parameter, -1, 20), p.vertices.front().position);
  EXPECT_NE(framed.vertex(p.parameter, -1, 20), (Vec2{0, 20.5}));  // a slanting curve goes on slanting
  EXPECT_EQ(framed.vertex(p.parameter, -1, 21), (Vec2{0, 21.5}));
}

TEST(BorderEnds, EndsNearADomainCornerStayAwayFromIt) {
  for (int x = 0; x < 6; ++x) {
    ChainBuilder b(50, 40);
    ASSERT_TRUE(b.add({{x + 0.5, 0.5}, {25.5, 25.5}}));
    const Parametrization p = run_sound(b.chains);
    const bool on_side = std::any_of(p.vertices.begin(), p.vertices.end(),
                                     [](const PolylineVertex& v) { return v.place != VertexPlace::kInside; });
    EXPECT_EQ(on_side, x >= 1);
  }
}

TEST(BorderEnds, ChainsThatStopShortOfTheBorderGoOn) {
  ChainBuilder b(50, 40);
  ASSERT_TRUE(b.add({{20.5, 2.5}, {22.5, 30.5}}));
  b.chains.chains[0].first_on_border = true;
  const Parametrization p = run_sound(b.chains);
  EXPECT_EQ(p.vertices.front().place, VertexPlace::kTop);
  EXPECT_EQ(p.curve_samples.size(), b.chains.chains[0].points.size() + 3);
}

}  // namespace
}  // namespace knotreel::param
