// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/squared_errors.h"

#include <gtest/gtest.h>

#include <cstddef>

namespace knotreel::fit {
namespace {

TEST(SquaredErrors, AreSummedOverChannelsOfPixelsThatCount) {
  constexpr std::size_t kPixels = 10000;  // more than are summed at once
  const image::Image picture = image::make_image(kPixels / 100, 100, 3);
  std::vector<float> residual(3 * kPixels);
  std::vector<float> weights(kPixels, 1);
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = static_cast<float>(i % 7) - 3;
  for (std::size_t i = 0; i < kPixels; i += 5) weights[i] = 0.5F;
  const std::vector<float> all = squared_errors(residual, {}, picture);
  const std::vector<float> counted = squared_errors(residual, weights, picture);
  ASSERT_EQ(all.size(), kPixels);
  ASSERT_EQ(counted.size(), kPixels);
  for (std::size_t i = 0; i < kPixels; ++i) {
    float sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += residual[3 * i + c] * residual[3 * i + c];
    ASSERT_EQ(all[i], sum) << i;
    ASSERT_EQ(counted[i], i % 5 == 0 ? 0 : sum) << i;
  }
}

TEST(SquaredErrors, ColoursCountByTheirAlpha) {
  const image::Image picture{3, 1, 2, {7, 0, 8, 127.5F, 9, 300}};
  const std::vector<float> residual{4, 3, 4, 3, 4, 3};
  EXPECT_EQ(squared_errors(residual, {}, picture), (std::vector<float>{9, 13, 25}));
}

TEST(SteeringWeights, AreThoseOfAlpha) {
  const image::Image opaque = image::make_image(2, 1, 3);
  EXPECT_TRUE(steering_weights(opaque, {}).empty());
  EXPECT_EQ(steering_weights(opaque, {1, 0.5F}), (std::vector<float>{1, 0.5F}));
  const image::Image picture{2, 1, 2, {7, 0, 8, 255}};
  const std::vector<float> weights = steering_weights(picture, {});
  EXPECT_GT(weights[0], 0);
  EXPECT_LT(weights[0], 0.1F);
  EXPECT_EQ(weights[1], 1);
  EXPECT_EQ(steering_weights(picture, {0, 0.5F}), (std::vector<float>{0, 0.5F}));
}

}  // namespace
}  // namespace knotreel::fit
