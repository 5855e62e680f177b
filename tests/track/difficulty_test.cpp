// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/difficulty.h"

#include <gtest/gtest.h>

#include "track/edge_picture.h"

namespace knotreel::track {
namespace {

double difficulty_of(image::Image picture, std::size_t functions, double mec = 0) {
  vectorize::Options cold;
  cold.mec = mec;
  return difficulty({std::move(picture), std::vector<float>{}}, cold, functions);
}

TEST(Difficulty, APlaneIsNone) {
  image::Image plane = image::make_image(96, 64, 3);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 96; ++x) {
      for (int c = 0; c < 3; ++c) plane.at(x, y, c) = static_cast<float>(x + 0.5 * y + 10 * c);
    }
  }
  // Slopes are drawn towards zero a little.
  EXPECT_LT(difficulty_of(plane, 100), 0.1 * 96 * 64);
}

TEST(Difficulty, FallsWithKnotsAndGrowsWithContrast) {
  image::Image strong = edge_at(40);
  for (float& v : strong.samples) v *= 2;
  EXPECT_LT(difficulty_of(edge_at(40), 400), 0.8 * difficulty_of(edge_at(40), 100));
  // The error is quadratic in the colours, and so is what decides where knots go.
  EXPECT_NEAR(difficulty_of(strong, 100) / difficulty_of(edge_at(40), 100), 4, 1e-6);
}

TEST(Difficulty, StopsWhereTheFrameWouldStop) {
  EXPECT_GT(difficulty_of(edge_at(40), 400, 8), 2 * difficulty_of(edge_at(40), 400));
}

}  // namespace
}  // namespace knotreel::track
