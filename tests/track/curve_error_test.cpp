// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/curve_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "knotreel/vectorize/vectorize.h"
#include "track/edge_picture.h"

namespace knotreel::track {
namespace {

TEST(CurveError, IsHowFarTheEdgesWent) {
  const document::FrameModel model = vectorize::vectorize_picture(edge_at(48)).model;
  ASSERT_FALSE(model.space->mesh().segments.empty());
  for (const double far : {0.0, 0.5, 1.0, -1.5, 2.0}) {
    const double distance = std::abs(far) / std::hypot(1.0, 0.3);
    EXPECT_NEAR(curve_error(model, motion::luma_of(edge_at(48 + far))), distance, 0.12) << far;
  }
}

TEST(CurveError, IsZeroWithoutCurvesAndWithoutEdges) {
  const image::Image flat = image::make_image(96, 64, 1);
  EXPECT_EQ(curve_error(vectorize::vectorize_picture(flat).model, motion::luma_of(edge_at(48))), 0);
  EXPECT_EQ(curve_error(vectorize::vectorize_picture(edge_at(48)).model, motion::luma_of(flat)), 0);
}

}  // namespace
}  // namespace knotreel::track
