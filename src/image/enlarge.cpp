// SPDX-License-Identifier: GPL-3.0-or-later
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
static_assert(kReachOfEnlarging == 2 * (1 + kCorrections));
// A block, and what it takes to enlarge it, fits into the cache of a core.
constexpr int kBlockWidth = 128;
constexpr int kBlockHeight = 64;

// Cubic convolution with a slope of -0.75, a quarter of a pixel before a sample: of the two samples before
// it, itself and the one behind. A quarter behind it is the mirror of that.
constexpr std::array<float, 4> kWeights{-0.03515625F, 0.26171875F, 0.87890625F, -0.10546875F};

using Five = std::array<const float*, 5>;  ///< a row of samples, with the two before and the two behind

KNOTREEL_MULTIVERSION
void quarters(const Five& s, std::size_t count, float* __restrict before, float* __restrict behind) {
  const auto [s0, s1, s2, s3, s4] = s;
  for (std::size_t i = 0; i < count; ++i) {
    const float middle = kWeights[2] * s2[i];
    before[i] = middle + kWeights[0] * s0[i] + kWeights[1] * s1[i] + kWeights[3] * s3[i];
    behind[i] = middle + kWeights[0] * s4[i] + kWeights[1] * s3[i] + kWeights[3] * s1[i];
  }
}

inline float within(float low, float value, float high) {
  const float v = value < low ? low : value;
  return high < v ? high : v;
}

// Without __restrict compilers would have to check more pairs of arrays for overlaps than they are willing
// to.
KNOTREEL_MULTIVERSION
void add_quarters(const Five& s, const float* low, const float* high, std::size_t count,
                  float* __restrict before, float* __restrict behind) {
  const auto [s0, s1, s2, s3, s4] = s;
  for (std::size_t i = 0; i < count; ++i) {
    const float middle = kWeights[2] * s2[i];
    const float above = middle + kWeights[0] * s0[i] + kWeights[1] * s1[i] + kWeights[3] * s3[i];
    const float below = middle + kWeights[0] * s4[i] + kWeights[1] * s3[i] + kWeights[3] * s1[i];
    before[i] = within(low[i], before[i] + above, high[i]);
    behind[i] = within(low[i], behind[i] + below, high[i]);
  }
}

KNOTREEL_MULTIVERSION
void widen_range(const float* samples, std::size_t count, float* __restrict low, float* __restrict high) {
  for (std::size_t i = 0; i < count; ++i) {
    low[i] = samples[i] < low[i] ? samples[i] : low[i];
    high[i] = high[i] < samples[i] ? samples[i] : high[i];
  }
}

/// Samples of one row and of another in turns.
KNOTREEL_MULTIVERSION
void interleave(const float* even, const float* odd, std::size_t count, float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i) {
    out[2 * i] = even[i];
    out[2 * i + 1] = odd[i];
  }
}

/// What the means of 2x2 samples lack.
KNOTREEL_MULTIVERSION
void find_missed(const float* want, const float* above, const float* below, std::size_t count,
                 float* __restrict out) {
  for (std::size_t i = 0; i < count; ++i)
    out[i] = want[i] - 0.25F * ((above[2 * i] + above[2 * i + 1]) + (below[2 * i] + below[2 * i + 1]));
}

/// A row with its first and last samples repeated.
std::vector<float> padded(std::span<const float> row, std::size_t samples) {
  std::vector<float> result(samples, row.front());
  result.insert(result.end(), row.begin(), row.end());
  result.insert(result.end(), samples, row.back());
  return result;
}

/// Least and largest of 3x3 samples, for two samples of a wider plane each. Planes are pictures with a single
/// channel.
struct Range {
  explicit Range(const Image& plane) : low(make_image(2 * plane.width, plane.height, 1)), high(low) {
    const auto count = std::size_t(plane.width);
    for (int y = 0; y < plane.height; ++y) {
      const auto here = plane.row(y);
      std::vector<float> least(here.begin(), here.end());
      std::vector<float> most = least;
      for (const int other : {std::max(0, y - 1), std::min(plane.height - 1, y + 1)})
        widen_range(plane.row(other).data(), count, least.data(), most.data());
      const std::vector<float> beside_least = padded(least, 1);
      const std::vector<float> beside_most = padded(most, 1);
      for (const std::size_t beside : {std::size_t{0}, std::size_t{2}}) {
        widen_range(&beside_least[beside], count, least.data(), most.data());
        widen_range(&beside_most[beside], count, least.data(), most.data());
      }
      interleave(least.data(), least.data(), count, low.row(y).data());
      interleave(most.data(), most.data(), count, high.row(y).data());
    }
  }

  Image low;
  Image high;
};

/// Adds a plane, interpolated, to an enlarged one, which stays within a range. @param wide room for one of
/// twice the width.
void add_interpolated(const Image& plane, const Range& range, Image& wide, Image& enlarged) {
  const auto count = std::size_t(plane.width);
  std::vector<float> before(count);
  std::vector<float> behind(count);
  Five s{};
  for (int y = 0; y < plane.height; ++y) {
    const std::vector<float> in = padded(plane.row(y), 2);
    for (std::size_t k = 0; k < s.size(); ++k) s[k] = &in[k];
    quarters(s, count, before.data(), behind.data());
    interleave(before.data(), behind.data(), count, wide.row(y).data());
  }
  for (int y = 0; y < plane.height; ++y) {
    for (int k = 0; k < int(s.size()); ++k)
      s[std::size_t(k)] = wide.row(std::clamp(y + k - 2, 0, plane.height - 1)).data();
    add_quarters(s, range.low.row(y).data(), range.high.row(y).data(), 2 * count, enlarged.row(2 * y).data(),
                 enlarged.row(2 * y + 1).data());
  }
}

Image enlarge_plane(const Image& plane) {
  const Range range(plane);
  Image wide = make_image(2 * plane.width, plane.height, 1);
  Image result = make_image(2 * plane.width, 2 * plane.height, 1);
  add_interpolated(plane, range, wide, result);
  Image missed = make_image(plane.width, plane.height, 1);
  for (int i = 0; i < kCorrections; ++i) {
    for (int y = 0; y < plane.height; ++y)
      find_missed(plane.row(y).data(), result.row(2 * y).data(), result.row(2 * y + 1).data(),
                  std::size_t(plane.width), missed.row(y).data());
    add_interpolated(missed, range, wide, result);
  }
  return result;
}

/// Pixels of a picture.
struct Block {
  int left = 0;
  int top = 0;
  int right = 0;
  int bottom = 0;

  /// With all that it hangs on.
  Block wider(const Image& image) const {
    return {std::max(0, left - kReachOfEnlarging), std::max(0, top - kReachOfEnlarging),
            std::min(image.width, right + kReachOfEnlarging),
            std::min(image.height, bottom + kReachOfEnlarging)};
  }
};

std::vector<Block> blocks_of(const Image& image) {
  std::vector<Block> blocks;
  for (int y = 0; y < image.height; y += kBlockHeight) {
    for (int x = 0; x < image.width; x += kBlockWidth)
      blocks.push_back(
          {x, y, std::min(image.width, x + kBlockWidth), std::min(image.height, y + kBlockHeight)});
  }
  return blocks;
}

/// A row of a block.
template <class Samples>
auto row_of(Samples& image, const Block& block, int y) {
  const auto channels = std::size_t(image.channels);
  return image.row(y).subspan(std::size_t(block.left) * channels,
                              std::size_t(block.right - block.left) * channels);
}

/// A channel of a block.
Image plane_of(const Image& image, const Block& block, int channel) {
  Image plane = make_image(block.right - block.left, block.bottom - block.top, 1);
  for (int y = 0; y < plane.height; ++y) {
    const auto row = row_of(image, block, block.top + y);
    const auto out = plane.row(y);
    for (std::size_t i = 0, k = std::size_t(channel); i < out.size(); ++i, k += std::size_t(image.channels))
      out[i] = row[k];
  }
  return plane;
}

/// @param from in the plane, as large as the block in the picture.
void set_channel(const Image& plane, const Block& from, int channel, const Block& to, Image& image) {
  for (int y = 0; y < to.bottom - to.top; ++y) {
    const auto row = row_of(plane, from, from.top + y);
    const auto out = row_of(image, to, to.top + y);
    for (std::size_t i = 0, k = std::size_t(channel); i < row.size(); ++i, k += std::size_t(image.channels))
      out[k] = row[i];
  }
}

/// Where a block is in a picture that begins there, and is enlarged.
Block twice(const Block& block, int x, int y) {
  return {2 * (block.left - x), 2 * (block.top - y), 2 * (block.right - x), 2 * (block.bottom - y)};
}

}  // namespace

Image enlarge_twofold(const Image& image) {
  Image result = make_image(2 * image.width, 2 * image.height, image.channels);
  const std::vector<Block> blocks = blocks_of(image);
  parallel_for(blocks.size(), [&](std::size_t b) {
    const Block wider = blocks[b].wider(image);
    const Block place = twice(blocks[b], 0, 0);
    for (int c = 0; c < image.channels; ++c)
      set_channel(enlarge_plane(plane_of(image, wider, c)), twice(blocks[b], wider.left, wider.top), c, place,
                  result);
  });
  return result;
}

}  // namespace knotreel::image
