#include "knotreel/track/curve_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "knotreel/vectorize/vectorize.h"

namespace knotreel::track {
namespace {

/// Dark at the left and bright at the right of a slanted edge, which crosses the middle row at x.
image::Image edge_at(double x) {
  image::Image image = image::make_image(96, 64, 1);
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      const double across = (i + 0.5 - x + 0.3 * (j + 0.5 - 32)) / std::hypot(1.0, 0.3);
      image.at(i, j, 0) = static_cast<float>(50 + 150 * std::clamp(across + 0.5, 0.0, 1.0));
    }
  }
  return image;
}

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
