// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <string>

#include "support/chains.h"
#include "vectorize/mapped_picture.h"

namespace knotreel::vectorize {
namespace {

constexpr int kRingsWidth = 120, kRingsHeight = 80;

/// Two rings, of which the second has two corners next to each other that are `apart` pixels apart.
Curves rings(double apart) {
  knotreel::testing::ChainBuilder builder(kRingsWidth, kRingsHeight);
  builder.add(knotreel::testing::arc({30, 40}, 18), true);
  builder.add(knotreel::testing::arc({85, 40}, 18), true);
  std::vector<features::ChainPoint>& points = builder.chains.chains[1].points;
  points[10].corner = points[11].corner = true;
  const Vec2 way = points[11].position - points[10].position;
  points[11].move_to(points[10].position + apart / norm(way) * way);
  return {builder.chains, builder.chains};
}

struct Mapped {
  bool is_sound;
  MappedPicture picture;
};

Mapped mapped(const Curves& curves) {
  const image::Image picture = image::make_image(kRingsWidth, kRingsHeight, 3);
  const Observer nobody;
  RunLog log(picture, nobody);
  log.begin_round("features");
  features::KnownCorners known;
  Mapped result;
  result.is_sound = map_curves(picture, {}, 10000, curves, {}, known, log, result.picture);
  return result;
}

TEST(MapCurves, MakesAPolylineOfEachCurve) {
  const Mapped result = mapped(rings(0.5));
  EXPECT_TRUE(result.is_sound);
  EXPECT_EQ(result.picture.parametrization.polylines.size(), 2U);
}

/// A letter's dot is missed for a frame; else the whole frame would be made anew, and the next ones, too.
TEST(MapCurves, LeavesACurveOutThatWouldHaveTooShortASegment) {
  for (const double apart : {0.15, 0.01}) {
    SCOPED_TRACE(apart);
    const Mapped result = mapped(rings(apart));
    EXPECT_TRUE(result.is_sound);
    ASSERT_EQ(result.picture.parametrization.polylines.size(), 1U);
    for (const param::PolylineVertex& v : result.picture.parametrization.vertices)
      EXPECT_LT(v.position.x, 60) << "the first ring";
    EXPECT_FALSE(result.picture.knots.segments.empty());
  }
}

TEST(MapCurves, MayLeaveAllOut) {
  Curves curves = rings(0.01);
  curves.faired.chains.erase(curves.faired.chains.begin());
  const Mapped result = mapped(curves);
  EXPECT_TRUE(result.is_sound);
  EXPECT_FALSE(result.picture.has_features());
  EXPECT_TRUE(result.picture.knots.segments.empty());
}

}  // namespace
}  // namespace knotreel::vectorize
