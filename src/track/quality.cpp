#include "track/quality.h"

#include <cmath>

namespace knotreel::track {

Quality quality_of(std::span<const float> residual, std::span<const float> weights, int channel_count) {
  const auto channels = static_cast<std::size_t>(channel_count);
  double length = 0;
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < residual.size() / channels; ++i) {
    if (!weights.empty() && weights[i] < 1) continue;
    double squared = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      const double d = static_cast<double>(residual[i * channels + c]);
      squared += d * d;
    }
    length += std::sqrt(squared);
    squares += squared;
    ++count;
  }
  if (count == 0) return {};
  const double n = static_cast<double>(count);
  return {length / n, 10 * std::log10(255.0 * 255.0 * n * static_cast<double>(channels) / squares)};
}

}  // namespace knotreel::track
