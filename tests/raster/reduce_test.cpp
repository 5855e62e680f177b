// SPDX-License-Identifier: GPL-3.0-or-later
#include "raster/reduce.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "raster/colour_mean.h"

namespace knotreel::raster {
namespace {

/// Samples that show in which order they were added up.
float sample(int x, int y, std::size_t channel) {
  const auto mixed =
      static_cast<std::uint32_t>(x) * 2654435761u + static_cast<std::uint32_t>(y) * 40503u * 65537u;
  return 0.1f + static_cast<float>((mixed >> (8 + channel)) % 255);
}

DrawFine drawing(std::size_t channels, std::size_t& most) {
  return [=, &most](const Region& fine, float* out) {
    most = std::max(most, fine.pixel_count() * channels);
    for (int y = fine.row_begin; y < fine.row_end; ++y) {
      for (int x = fine.column_begin; x < fine.column_end; ++x) {
        for (std::size_t c = 0; c < channels; ++c) *out++ = sample(x, y, c);
      }
    }
  };
}

void expect_means(const Part& part, Reduction by) {
  for (int y = part.row_begin; y < part.row_end; ++y) {
    for (int x = part.column_begin; x < part.column_end; ++x) {
      ColourMean mean(part.channels);
      for (int j = y * by.y; j < (y + 1) * by.y; ++j) {
        for (int i = x * by.x; i < (x + 1) * by.x; ++i) {
          float fine[4];
          for (std::size_t c = 0; c < part.channels; ++c) fine[c] = sample(i, j, c);
          mean.add(fine, 1);
        }
      }
      float expected[4];
      mean.store(expected);
      for (std::size_t c = 0; c < part.channels; ++c)
        EXPECT_EQ(part.at(x, y)[c], expected[c]) << x << ' ' << y;
    }
  }
}

TEST(Reduce, IsTheMeanInTheOrderOfRowsWithinFewSamples) {
  struct Case {
    int columns;
    std::size_t channels;
    Reduction by;
  };
  // All rows at once; one row at a time; some pixels at a time; bands of one pixel, of different height.
  const Case cases[] = {
      {5, 3, {4, 3}}, {700, 4, {20, 30}}, {9, 4, {300, 400}}, {2, 4, {1500, 1300}}, {2, 1, {3, 2'100'000}}};
  for (const Case& c : cases) {
    SCOPED_TRACE(c.by.y);
    std::vector<float> out(3 * static_cast<std::size_t>(c.columns) * c.channels);
    const Part part{{1, 4, 2, 2 + c.columns}, c.channels, out.data()};
    std::size_t most = 0;
    reduce_rows(part, c.by, drawing(c.channels, most));
    EXPECT_LE(most, kMostFine);
    expect_means(part, c.by);
  }
}

}  // namespace
}  // namespace knotreel::raster
