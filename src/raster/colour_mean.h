// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace knotreel::raster {

/// Mean of the samples of one pixel. Where there is alpha (the last of 2 or 4 channels), colours count by it,
/// so that the invisible colour of transparent samples does not bleed.
class ColourMean {
 public:
  explicit ColourMean(std::size_t channels) : channels_(channels), alpha_(channels == 2 || channels == 4) {}

  /// Adds the sample whose channel c is at sample[c * stride]. @param share how much it counts.
  template <class T>
  void add(const T* sample, std::size_t stride, double share = 1) {
    const double alpha = alpha_ ? std::max(static_cast<double>(sample[(channels_ - 1) * stride]), 0.0) : 1.0;
    weight_ += share * alpha;
    shares_ += share;
    for (std::size_t c = 0; c < channels_; ++c) {
      const double v = sample[c * stride];
      sum_[c] += (is_weighted(c) ? share * alpha : share) * v;
    }
  }

  void store(float* out) const {
    for (std::size_t c = 0; c < channels_; ++c) {
      const double by = is_weighted(c) ? weight_ : shares_;
      out[c] = static_cast<float>(by > 0 ? sum_[c] / by : 0.0);
    }
  }

 private:
  bool is_weighted(std::size_t c) const { return alpha_ && c + 1 < channels_; }

  std::size_t channels_;
  bool alpha_;
  double weight_ = 0;
  double shares_ = 0;
  std::array<double, 4> sum_{};
};

}  // namespace knotreel::raster
