#include "track/fitted_frame.h"

#include "knotreel/base/parallel.h"

namespace knotreel::track {

std::vector<float> squared_errors(const FittedFrame& frame) {
  const auto channels = static_cast<std::size_t>(frame.seen.picture.channels);
  const std::vector<float>& residual = frame.colours.residual;
  const std::vector<float>& weights = frame.seen.weights;
  std::vector<float> squared(residual.size() / channels);
  const auto width = static_cast<std::size_t>(frame.seen.picture.width);
  parallel_for(squared.size() / width, [&](std::size_t row) {
    for (std::size_t i = row * width; i < (row + 1) * width; ++i) {
      float sum = 0;
      for (std::size_t c = 0; c < channels; ++c)
        sum += residual[i * channels + c] * residual[i * channels + c];
      squared[i] = weights.empty() || weights[i] >= 1 ? sum : 0;
    }
  });
  return squared;
}

}  // namespace knotreel::track
