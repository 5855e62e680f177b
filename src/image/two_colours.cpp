// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/two_colours.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace knotreel::image {
namespace {

constexpr float kOfContrast = 0.03F;  // that colours of one side may differ by
constexpr float kLeastContrast = 4;   // levels: below that, 8 bits have hardly a colour in between

}  // namespace

bool has_two_colours(const Image& picture, int left, int top) {
  bool two = false;
  float most = kLeastContrast;
  for (int c = 0; c < picture.channels; ++c) {
    std::array<float, 9> samples{};
    for (int i = 0; i < 9; ++i) samples[std::size_t(i)] = picture.at(left + i % 3, top + i / 3, c);
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

}  // namespace knotreel::image
