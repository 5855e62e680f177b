// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/temporal_target.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <vector>

#include "knotreel/base/parallel.h"
#include "knotreel/spline/pixel_tiles.h"

namespace knotreel::track {

namespace {

constexpr std::size_t kTile = spline::PixelTiles::kSide;  // pixels
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

/// Takes the shares of what was missed off a picture with C channels.
template <std::size_t C>
class TakeOff {
 public:
  TakeOff(std::span<const float> residual, std::span<const float> weights, const motion::FlowPair& flow,
          float still_share, float moving_share, float limit, image::Image& target)
      : residual_(residual),
        weights_(weights),
        flow_(flow),
        still_share_(still_share),
        moving_share_(moving_share),
        limit_(limit),
        target_(target),
        width_(static_cast<std::size_t>(target.width)) {}

  /// Off the pixels of a row from begin to end.
  void operator()(std::size_t row, std::size_t begin, std::size_t end) const {
    for (std::size_t x = begin; x < end; ++x) {
      const std::size_t first = row * width_ + x;
      if (!flow_.consistent_back[first]) continue;
      if (!is_still(first)) {
        along_motion(row, x);
        continue;
      }
      std::size_t i = first;  // up to the next pixel that is another matter: without branches, for vectors
      while (x < end && flow_.consistent_back[i] && is_still(i) && is_ordinary(weights_, i)) ++x, ++i;
      at_rest(first * C, i * C);
      if (i > first) --x;
    }
  }

 private:
  bool is_still(std::size_t pixel) const {
    return std::abs(flow_.backward.xy[2 * pixel]) < kStill &&
           std::abs(flow_.backward.xy[2 * pixel + 1]) < kStill;
  }

  void at_rest(std::size_t begin, std::size_t end) const {
    const float* const missed = residual_.data();
    float* const out = target_.samples.data();
    for (std::size_t i = begin; i < end; ++i) {
      const float low = missed[i] < -limit_ ? -limit_ : missed[i];
      out[i] -= still_share_ * (low > limit_ ? limit_ : low);
    }
  }

  void along_motion(std::size_t row, std::size_t x) const {
    const std::size_t i = row * width_ + x;
    const float right = static_cast<float>(target_.width - 1),
                bottom = static_cast<float>(target_.height - 1);
    const float px = std::clamp(static_cast<float>(x) + flow_.backward.xy[2 * i], 0.0F, right);
    const float py = std::clamp(static_cast<float>(row) + flow_.backward.xy[2 * i + 1], 0.0F, bottom);
    const auto x0 = static_cast<std::size_t>(px);
    const auto y0 = static_cast<std::size_t>(py);
    const float fx = px - static_cast<float>(x0);
    const float fy = py - static_cast<float>(y0);
    const std::size_t upper = y0 * width_ + x0;
    const std::size_t next = x0 + 1 < width_ ? 1 : 0;
    const std::size_t lower = y0 + 1 < static_cast<std::size_t>(target_.height) ? upper + width_ : upper;
    const std::size_t from[4] = {upper, upper + next, lower, lower + next};
    const float part[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
    for (const std::size_t f : from) {
      if (!is_ordinary(weights_, f)) return;
    }
    for (std::size_t c = 0; c < C; ++c) {
      float missed = 0;
      for (std::size_t k = 0; k < 4; ++k) missed += part[k] * residual_[from[k] * C + c];
      target_.samples[i * C + c] -= moving_share_ * missed;
    }
  }

  std::span<const float> residual_;
  std::span<const float> weights_;
  const motion::FlowPair& flow_;
  float still_share_;
  float moving_share_;
  float limit_;
  image::Image& target_;
  std::size_t width_;
};

template <std::size_t C>
void take_off(const TakeOff<C>& off, int width, int height, std::span<const std::uint8_t> tiles) {
  const auto columns = (static_cast<std::size_t>(width) + kTile - 1) / kTile;
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
    if (tiles.empty()) return off(row, 0, static_cast<std::size_t>(width));
    const std::uint8_t* const here = tiles.data() + row / kTile * columns;
    for (std::size_t t = 0; t < columns; ++t) {
      if (here[t]) off(row, t * kTile, std::min(static_cast<std::size_t>(width), (t + 1) * kTile));
    }
  });
}

}  // namespace

image::Image temporal_target(const image::Image& picture, std::span<const float> residual,
                             std::span<const float> weights, const Motion& motion, double share,
                             std::span<const std::uint8_t> tiles) {
  image::Image target = picture;
  if (share <= 0 || residual.size() != picture.samples.size()) return target;
  const auto moving_share = static_cast<float>(share);
  const auto still_share = static_cast<float>(1 - (1 - share) * (1 - share));
  const auto limit = static_cast<float>(kOutlier * mean_absolute(residual, weights, picture));
  const auto with = [&]<std::size_t C>(std::integral_constant<std::size_t, C>) {
    take_off(TakeOff<C>(residual, weights, motion.flow, still_share, moving_share, limit, target),
             picture.width, picture.height, tiles);
  };
  switch (picture.channels) {
    case 1:
      with(std::integral_constant<std::size_t, 1>{});
      break;
    case 2:
      with(std::integral_constant<std::size_t, 2>{});
      break;
    case 3:
      with(std::integral_constant<std::size_t, 3>{});
      break;
    default:
      with(std::integral_constant<std::size_t, 4>{});
  }
  return target;
}

}  // namespace knotreel::track
