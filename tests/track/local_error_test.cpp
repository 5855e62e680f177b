// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/local_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/mesh_cases.h"

namespace knotreel::track {
namespace {

/// Against the plain mean over the pixels of the tile, one function at a time.
TEST(LocalErrors, AreMeansOverTheTilesOfTheGrevilleSites) {
  constexpr std::uint64_t kSeed = 20261124;
  std::mt19937_64 random(kSeed);
  std::normal_distribution<float> error(0, 9);
  for (const auto& c : testing::random_cases(23, 10)) {
    const spline::SplineSpace space(c.mesh, 2);
    const int width = static_cast<int>(c.mesh.width);
    const int height = static_cast<int>(c.mesh.height);
    for (const int channels : {1, 3}) {
      std::vector<float> residual(static_cast<std::size_t>(width * height * channels));
      for (float& r : residual) r = error(random);
      const std::vector<double> found = local_errors(space, residual, width, height, channels);
      ASSERT_EQ(found.size(), space.function_count());
      for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
        // Sites on the far border belong to the last tile.
        const int column = std::min(static_cast<int>(space.greville(f).x), width - 1) / 8;
        const int row = std::min(static_cast<int>(space.greville(f).y), height - 1) / 8;
        double sum = 0;
        int count = 0;
        for (int i = 0; i < width * height * channels; ++i) {
          const int pixel = i / channels;
          if (pixel % width / 8 != column || pixel / width / 8 != row) continue;
          sum += std::abs(static_cast<double>(residual[static_cast<std::size_t>(i)]));
          ++count;
        }
        EXPECT_NEAR(found[f], sum / count, 1e-4) << c.name << ' ' << f;
      }
    }
  }
}

}  // namespace
}  // namespace knotreel::track
