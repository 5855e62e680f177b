#include "knotreel/image/enlarge.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"

namespace knotreel::image {
namespace {

constexpr int kCorrections = 3;

// Cubic convolution with a slope of -0.75, a quarter of a pixel before a sample: of the two samples before
// it, itself and the one behind. A quarter behind it is the mirror of that.
constexpr std::array<float, 4> kWeights{-0.03515625F, 0.26171875F, 0.87890625F, -0.10546875F};

using Five = std::array<const float*, 5>;  ///< a row of samples, with the two before and the two behind

KNOTREEL_MULTIVERSION
void quarters(const Five& s, std::size_t count, float* before, float* behind) {
  for (std::size_t i = 0; i < count; ++i) {
    const float middle = kWeights[2] * s[2][i];
    before[i] = middle + kWeights[0] * s[0][i] + kWeights[1] * s[1][i] + kWeights[3] * s[3][i];
    behind[i] = middle + kWeights[0] * s[4][i] + kWeights[1] * s[3][i] + kWeights[3] * s[1][i];
  }
}

float within(float low, float value, float high) {
  return value < low ? low : high < value ? high : value;
}

KNOTREEL_MULTIVERSION
void add_quarters(const Five& s, const float* low, const float* high, std::size_t count, float* before,
                  float* behind) {
  for (std::size_t i = 0; i < count; ++i) {
    const float middle = kWeights[2] * s[2][i];
    const float above = middle + kWeights[0] * s[0][i] + kWeights[1] * s[1][i] + kWeights[3] * s[3][i];
    const float below = middle + kWeights[0] * s[4][i] + kWeights[1] * s[3][i] + kWeights[3] * s[1][i];
    before[i] = within(low[i], before[i] + above, high[i]);
    behind[i] = within(low[i], behind[i] + below, high[i]);
  }
}

KNOTREEL_MULTIVERSION
void widen_range(const float* samples, std::size_t count, float* low, float* high) {
  for (std::size_t i = 0; i < count; ++i) {
    low[i] = samples[i] < low[i] ? samples[i] : low[i];
    high[i] = high[i] < samples[i] ? samples[i] : high[i];
  }
}

/// A row with its first and last pixels repeated.
std::vector<float> padded(const std::vector<float>& row, std::size_t channels, std::size_t pixels) {
  std::vector<float> result(row.size() + 2 * pixels * channels);
  std::copy(row.begin(), row.end(), result.begin() + std::ptrdiff_t(pixels * channels));
  for (std::size_t i = 0; i < pixels * channels; ++i) {
    result[i] = row[i % channels];
    result[result.size() - 1 - i] = row[row.size() - 1 - i % channels];
  }
  return result;
}

/// Pixels of one row and of another in turns.
void interleave(const std::vector<float>& even, const std::vector<float>& odd, std::size_t channels,
                std::span<float> out) {
  for (std::size_t i = 0, o = 0; i < even.size(); i += channels, o += 2 * channels) {
    for (std::size_t c = 0; c < channels; ++c) {
      out[o + c] = even[i + c];
      out[o + channels + c] = odd[i + c];
    }
  }
}

/// Least and largest samples of 3x3 pixels, for two pixels of a wider picture each.
struct Range {
  explicit Range(const Image& image)
      : low(make_image(2 * image.width, image.height, image.channels)), high(low) {
    const auto channels = std::size_t(image.channels);
    parallel_for(std::size_t(image.height), [&](std::size_t row) {
      const int y = int(row);
      const auto here = image.row(y);
      std::vector<float> least(here.begin(), here.end());
      std::vector<float> most = least;
      for (const int other : {std::max(0, y - 1), std::min(image.height - 1, y + 1)})
        widen_range(image.row(other).data(), least.size(), least.data(), most.data());
      const std::vector<float> beside_least = padded(least, channels, 1);
      const std::vector<float> beside_most = padded(most, channels, 1);
      for (const std::size_t beside : {std::size_t{0}, 2 * channels}) {
        widen_range(&beside_least[beside], least.size(), least.data(), most.data());
        widen_range(&beside_most[beside], least.size(), least.data(), most.data());
      }
      interleave(least, least, channels, low.row(y));
      interleave(most, most, channels, high.row(y));
    });
  }

  Image low;
  Image high;
};

/// Adds a picture, interpolated, to an enlarged one, which stays within a range. @param wide room for one of
/// twice the width.
void add_interpolated(const Image& image, const Range& range, Image& wide, Image& enlarged) {
  const auto channels = std::size_t(image.channels);
  parallel_for(std::size_t(image.height), [&](std::size_t y) {
    const auto row = image.row(int(y));
    const std::vector<float> in = padded({row.begin(), row.end()}, channels, 2);
    Five s{};
    for (std::size_t k = 0; k < s.size(); ++k) s[k] = &in[k * channels];
    std::vector<float> before(row.size());
    std::vector<float> behind(row.size());
    quarters(s, row.size(), before.data(), behind.data());
    interleave(before, behind, channels, wide.row(int(y)));
  });
  parallel_for(std::size_t(image.height), [&](std::size_t row) {
    const int y = int(row);
    Five s{};
    for (int k = 0; k < int(s.size()); ++k)
      s[std::size_t(k)] = wide.row(std::clamp(y + k - 2, 0, image.height - 1)).data();
    add_quarters(s, range.low.row(y).data(), range.high.row(y).data(), wide.row(y).size(),
                 enlarged.row(2 * y).data(), enlarged.row(2 * y + 1).data());
  });
}

/// What the means of 2x2 pixels lack.
void find_missed(const Image& image, const Image& enlarged, Image& missed) {
  const auto channels = std::size_t(image.channels);
  parallel_for(std::size_t(image.height), [&](std::size_t y) {
    const auto want = image.row(int(y));
    const auto above = enlarged.row(2 * int(y));
    const auto below = enlarged.row(2 * int(y) + 1);
    const auto out = missed.row(int(y));
    for (std::size_t i = 0, left = 0; i < want.size(); i += channels, left += 2 * channels) {
      for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t a = left + c;
        const std::size_t b = a + channels;
        out[i + c] = want[i + c] - 0.25F * ((above[a] + above[b]) + (below[a] + below[b]));
      }
    }
  });
}

}  // namespace

Image enlarge_twofold(const Image& image) {
  const Range range(image);
  Image wide = make_image(2 * image.width, image.height, image.channels);
  Image result = make_image(2 * image.width, 2 * image.height, image.channels);
  add_interpolated(image, range, wide, result);
  Image missed = make_image(image.width, image.height, image.channels);
  for (int i = 0; i < kCorrections; ++i) {
    find_missed(image, result, missed);
    add_interpolated(missed, range, wide, result);
  }
  return result;
}

}  // namespace knotreel::image
