#include "knotreel/features/flat_share.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include "knotreel/base/parallel.h"

namespace knotreel::features {

namespace {

/// Pixels by their largest second difference along the row and the column, in any channel.
struct Differences {
  std::size_t flat = 0;   ///< at most a level
  std::size_t small = 0;  ///< up to kSmall
  std::size_t large = 0;
};

constexpr float kFlat = 1;  // levels
constexpr float kSmall = 8;

/// Without the pixels at the sides.
Differences differences_of(const image::Image& image) {
  if (image.width < 3 || image.height < 3) return {};
  const auto channels = static_cast<std::size_t>(image.channels);
  const auto columns = static_cast<std::size_t>(image.width - 2);
  const std::size_t stride = (columns + 2) * channels;
  std::vector<Differences> rows(static_cast<std::size_t>(image.height - 2));
  parallel_for(rows.size(), [&](std::size_t row) {
    const float* pixel = image.samples.data() + (row + 1) * stride + channels;
    for (std::size_t x = 0; x < columns; ++x, pixel += channels) {
      float most = 0;
      for (std::size_t c = 0; c < channels; ++c) {
        const float* sample = pixel + c;
        const float along = 2 * *sample - *(sample - channels) - *(sample + channels);
        const float across = 2 * *sample - *(sample - stride) - *(sample + stride);
        most = std::max({most, std::abs(along), std::abs(across)});
      }
      ++(most <= kFlat ? rows[row].flat : most <= kSmall ? rows[row].small : rows[row].large);
    }
  });
  return std::accumulate(
      rows.begin(), rows.end(), Differences(), [](Differences sum, const Differences& row) {
        return Differences{sum.flat + row.flat, sum.small + row.small, sum.large + row.large};
      });
}

}  // namespace

double flat_share(const image::Image& image) {
  const Differences differences = differences_of(image);
  const std::size_t count = differences.flat + differences.small + differences.large;
  return count == 0 ? 0 : static_cast<double>(differences.flat) / static_cast<double>(count);
}

bool is_drawing(const image::Image& image) {
  constexpr double kDrawnShare = 0.6;  // what is left of films by codecs has 0.5 and less
  return flat_share(image) >= kDrawnShare;
}

bool is_clean(const image::Image& image) {
  constexpr double kMostSmall = 0.6;  // times the number of large ones
  const Differences differences = differences_of(image);
  return static_cast<double>(differences.small) <= kMostSmall * static_cast<double>(differences.large);
}

}  // namespace knotreel::features
