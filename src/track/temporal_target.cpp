#include "track/temporal_target.h"

#include <algorithm>
#include <cmath>

#include "knotreel/base/parallel.h"

namespace knotreel::track {

namespace {

constexpr float kStill = 0.3F;  // pixels; shorter motion is none, so that the residual need not be resampled

}  // namespace

image::Image temporal_target(const image::Image& picture, std::span<const float> residual,
                             std::span<const float> weights, const Motion& motion, double share) {
  image::Image target = picture;
  if (share <= 0 || residual.size() != picture.samples.size()) return target;
  const int width = picture.width;
  const int height = picture.height;
  const auto channels = static_cast<std::size_t>(picture.channels);
  const auto at = [&](int x, int y) {
    return std::size_t(std::clamp(y, 0, height - 1)) * std::size_t(width) +
           std::size_t(std::clamp(x, 0, width - 1));
  };
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t row) {
    for (int x = 0; x < width; ++x) {
      const std::size_t i = at(x, static_cast<int>(row));
      if (!motion.flow.consistent_back[i]) continue;
      const float dx = motion.flow.backward.xy[2 * i];
      const float dy = motion.flow.backward.xy[2 * i + 1];
      if (std::abs(dx) < kStill && std::abs(dy) < kStill) {
        if (!weights.empty() && weights[i] != 1.0F) continue;
        for (std::size_t c = 0; c < channels; ++c)
          target.samples[i * channels + c] -= static_cast<float>(share) * residual[i * channels + c];
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
      for (const std::size_t f : from) ordinary = ordinary && (weights.empty() || weights[f] == 1.0F);
      if (!ordinary) continue;
      for (std::size_t c = 0; c < channels; ++c) {
        float missed = 0;
        for (std::size_t k = 0; k < 4; ++k) missed += part[k] * residual[from[k] * channels + c];
        target.samples[i * channels + c] -= static_cast<float>(share) * missed;
      }
    }
  });
  return target;
}

}  // namespace knotreel::track
