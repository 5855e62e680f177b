#include "track/temporal_target.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "knotreel/base/parallel.h"

namespace knotreel::track {

namespace {

constexpr int kTile = 8;        // pixels
constexpr float kStill = 0.3F;  // pixels; shorter motion is none, so that the residual need not be resampled
/// Times the mean absolute residual, from which on a miss is an edge out of place.
constexpr double kOutlier = 6;

bool is_ordinary(std::span<const float> weights, std::size_t pixel) {
  return weights.empty() || weights[pixel] == 1.0F;
}

/// Of the pixels that are not on features; sums by rows, so that threads do not matter.
double mean_absolute(std::span<const float> residual, std::span<const float> weights,
                     const image::Image& picture) {
  struct Sum {
    float absolute = 0;
    std::size_t count = 0;
  };
  const auto width = static_cast<std::size_t>(picture.width);
  const auto channels = static_cast<std::size_t>(picture.channels);
  std::vector<Sum> rows(static_cast<std::size_t>(picture.height));
  parallel_for(rows.size(), [&](std::size_t row) {
    Sum sum;
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      if (!is_ordinary(weights, i)) continue;
      for (std::size_t c = 0; c < channels; ++c) sum.absolute += std::abs(residual[i * channels + c]);
      sum.count += channels;
    }
    rows[row] = sum;
  });
  double sum = 0;
  std::size_t count = 0;
  for (const Sum& row : rows) {
    sum += static_cast<double>(row.absolute);
    count += row.count;
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

}  // namespace

image::Image temporal_target(const image::Image& picture, std::span<const float> residual,
                             std::span<const float> weights, const Motion& motion, double share,
                             std::span<const std::uint8_t> tiles) {
  image::Image target = picture;
  if (share <= 0 || residual.size() != picture.samples.size()) return target;
  const int width = picture.width;
  const int height = picture.height;
  const auto channels = static_cast<std::size_t>(picture.channels);
  const auto moving_share = static_cast<float>(share);
  const auto still_share = static_cast<float>(1 - (1 - share) * (1 - share));
  const auto limit = static_cast<float>(kOutlier * mean_absolute(residual, weights, picture));
  const auto at = [&](int x, int y) {
    return std::size_t(std::clamp(y, 0, height - 1)) * std::size_t(width) +
           std::size_t(std::clamp(x, 0, width - 1));
  };
  const auto take_off = [&](std::size_t row, int begin, int end) {
    for (int x = begin; x < end; ++x) {
      const std::size_t i = at(x, static_cast<int>(row));
      if (!motion.flow.consistent_back[i]) continue;
      const float dx = motion.flow.backward.xy[2 * i];
      const float dy = motion.flow.backward.xy[2 * i + 1];
      if (std::abs(dx) < kStill && std::abs(dy) < kStill) {
        if (!is_ordinary(weights, i)) continue;
        for (std::size_t c = 0; c < channels; ++c)
          target.samples[i * channels + c] -=
              still_share * std::clamp(residual[i * channels + c], -limit, limit);
        continue;
      }
      const float px = std::clamp(static_cast<float>(x) + dx, 0.0F, static_cast<float>(width - 1));
      const float py = std::clamp(static_cast<float>(row) + dy, 0.0F, static_cast<float>(height - 1));
      const int x0 = static_cast<int>(px);
      const int y0 = static_cast<int>(py);
      const float fx = px - static_cast<float>(x0);
      const float fy = py - static_cast<float>(y0);
      const std::size_t from[4] = {at(x0, y0), at(x0 + 1, y0), at(x0, y0 + 1), at(x0 + 1, y0 + 1)};
      const float part[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
      bool ordinary = true;
      for (const std::size_t f : from) ordinary = ordinary && is_ordinary(weights, f);
      if (!ordinary) continue;
      for (std::size_t c = 0; c < channels; ++c) {
        float missed = 0;
        for (std::size_t k = 0; k < 4; ++k) missed += part[k] * residual[from[k] * channels + c];
        target.samples[i * channels + c] -= moving_share * missed;
      }
    }
  };
  const int columns = (width + kTile - 1) / kTile;
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
    if (tiles.empty()) return take_off(row, 0, width);
    const std::uint8_t* const here = tiles.data() + row / kTile * static_cast<std::size_t>(columns);
    for (int t = 0; t < columns; ++t) {
      if (here[t]) take_off(row, t * kTile, std::min(width, (t + 1) * kTile));
    }
  });
  return target;
}

}  // namespace knotreel::track
