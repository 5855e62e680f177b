#include "knotreel/fit/squared_errors.h"

#include <gtest/gtest.h>

#include <cstddef>

namespace knotreel::fit {
namespace {

TEST(SquaredErrors, AreSummedOverChannelsOfPixelsThatCount) {
  constexpr std::size_t kPixels = 10000;  // more than are summed at once
  std::vector<float> residual(3 * kPixels);
  std::vector<float> weights(kPixels, 1);
  for (std::size_t i = 0; i < residual.size(); ++i) residual[i] = static_cast<float>(i % 7) - 3;
  for (std::size_t i = 0; i < kPixels; i += 5) weights[i] = 0.5F;
  const std::vector<float> all = squared_errors(residual, {}, 3);
  const std::vector<float> counted = squared_errors(residual, weights, 3);
  ASSERT_EQ(all.size(), kPixels);
  ASSERT_EQ(counted.size(), kPixels);
  for (std::size_t i = 0; i < kPixels; ++i) {
    float sum = 0;
    for (std::size_t c = 0; c < 3; ++c) sum += residual[3 * i + c] * residual[3 * i + c];
    ASSERT_EQ(all[i], sum) << i;
    ASSERT_EQ(counted[i], i % 5 == 0 ? 0 : sum) << i;
  }
}

}  // namespace
}  // namespace knotreel::fit
