#include "knotreel/fit/squared_errors.h"

#include <algorithm>

#include "knotreel/base/parallel.h"

namespace knotreel::fit {

std::vector<float> squared_errors(std::span<const float> residual, std::span<const float> weights,
                                  int channel_count) {
  constexpr std::size_t kBlock = 4096;
  const auto channels = static_cast<std::size_t>(channel_count);
  std::vector<float> squared(residual.size() / channels);
  parallel_for((squared.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    for (std::size_t i = block * kBlock; i < std::min(squared.size(), (block + 1) * kBlock); ++i) {
      float sum = 0;
      for (std::size_t c = 0; c < channels; ++c)
        sum += residual[i * channels + c] * residual[i * channels + c];
      squared[i] = weights.empty() || weights[i] >= 1 ? sum : 0;
    }
  });
  return squared;
}

}  // namespace knotreel::fit
