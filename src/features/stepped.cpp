#include "features/stepped.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace knotreel::features {
namespace {

constexpr double kShare = 0.9;        // of the points
constexpr float kOfContrast = 0.03F;  // that colours of one side may differ by
constexpr float kLeastContrast = 4;   // levels: below that, 8 bits have hardly a colour in between

/// In the channel that differs most.
bool has_two_colours(const image::Image& image, int left, int top) {
  bool two = false;
  float most = kLeastContrast;
  for (int c = 0; c < image.channels; ++c) {
    std::array<float, 9> samples{};
    for (int i = 0; i < 9; ++i) samples[std::size_t(i)] = image.at(left + i % 3, top + i / 3, c);
    const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
    const float contrast = *high - *low;
    if (contrast < most) continue;
    most = contrast;
    two = std::all_of(samples.begin(), samples.end(), [&, low = *low, high = *high](float sample) {
      return std::min(sample - low, high - sample) <= kOfContrast * contrast;
    });
  }
  return two;
}

}  // namespace

bool is_stepped(const image::Image& image, const Chain& chain) {
  std::size_t looked_at = 0;
  std::size_t stepped = 0;
  for (const ChainPoint& p : chain.points) {
    if (p.x < 1 || p.y < 1 || p.x > image.width - 2 || p.y > image.height - 2) continue;
    ++looked_at;
    stepped += has_two_colours(image, p.x - 1, p.y - 1) ? 1 : 0;
  }
  return looked_at > 0 && double(stepped) >= kShare * double(looked_at);
}

}  // namespace knotreel::features
