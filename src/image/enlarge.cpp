#include "knotreel/image/enlarge.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

#include "knotreel/base/parallel.h"

namespace knotreel::image {
namespace {

constexpr int kCorrections = 3;

// Cubic convolution with a slope of -0.75, a quarter of a pixel before a sample: of the two samples before
// it, itself and the one behind. A quarter behind it is the mirror of that.
constexpr std::array<float, 4> kWeights{-0.03515625F, 0.26171875F, 0.87890625F, -0.10546875F};

Image wider(const Image& image) {
  Image result = make_image(2 * image.width, image.height, image.channels);
  const auto channels = std::size_t(image.channels);
  parallel_for(std::size_t(image.height), [&](std::size_t y) {
    const auto in = image.row(int(y));
    const auto out = result.row(int(y));
    for (int x = 0; x < image.width; ++x) {
      const auto sample = [&](int at) {
        return &in[std::size_t(std::clamp(at, 0, image.width - 1)) * channels];
      };
      const std::array<const float*, 5> s{sample(x - 2), sample(x - 1), sample(x), sample(x + 1),
                                          sample(x + 2)};
      float* const pair = &out[2 * std::size_t(x) * channels];
      for (std::size_t c = 0; c < channels; ++c) {
        const float middle = kWeights[2] * s[2][c];
        pair[c] = middle + kWeights[0] * s[0][c] + kWeights[1] * s[1][c] + kWeights[3] * s[3][c];
        pair[channels + c] = middle + kWeights[0] * s[4][c] + kWeights[1] * s[3][c] + kWeights[3] * s[1][c];
      }
    }
  });
  return result;
}

Image higher(const Image& image) {
  Image result = make_image(image.width, 2 * image.height, image.channels);
  parallel_for(std::size_t(image.height), [&](std::size_t row) {
    const int y = int(row);
    const auto in = [&](int at) { return image.row(std::clamp(at, 0, image.height - 1)); };
    const std::array<std::span<const float>, 5> s{in(y - 2), in(y - 1), in(y), in(y + 1), in(y + 2)};
    const auto above = result.row(2 * y);
    const auto below = result.row(2 * y + 1);
    for (std::size_t i = 0; i < above.size(); ++i) {
      const float middle = kWeights[2] * s[2][i];
      above[i] = middle + kWeights[0] * s[0][i] + kWeights[1] * s[1][i] + kWeights[3] * s[3][i];
      below[i] = middle + kWeights[0] * s[4][i] + kWeights[1] * s[3][i] + kWeights[3] * s[1][i];
    }
  });
  return result;
}

Image interpolated(const Image& image) {
  return higher(wider(image));
}

/// What the means of 2x2 pixels lack.
Image missed(const Image& image, const Image& enlarged) {
  Image result = make_image(image.width, image.height, image.channels);
  const auto channels = std::size_t(image.channels);
  parallel_for(std::size_t(image.height), [&](std::size_t y) {
    const auto want = image.row(int(y));
    const auto above = enlarged.row(2 * int(y));
    const auto below = enlarged.row(2 * int(y) + 1);
    const auto out = result.row(int(y));
    for (std::size_t x = 0; x < std::size_t(image.width); ++x) {
      for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t i = x * channels + c;
        const std::size_t left = 2 * x * channels + c;
        out[i] = want[i] -
                 0.25F * ((above[left] + above[left + channels]) + (below[left] + below[left + channels]));
      }
    }
  });
  return result;
}

/// Least and largest samples of 3x3 pixels.
std::pair<Image, Image> range_around(const Image& image) {
  std::pair<Image, Image> range{image, image};
  const auto channels = std::size_t(image.channels);
  parallel_for(std::size_t(image.height), [&](std::size_t row) {
    const auto low = range.first.row(int(row));
    const auto high = range.second.row(int(row));
    for (int y = std::max(0, int(row) - 1); y <= std::min(image.height - 1, int(row) + 1); ++y) {
      const auto in = image.row(y);
      for (int x = 0; x < image.width; ++x) {
        for (int at = std::max(0, x - 1); at <= std::min(image.width - 1, x + 1); ++at) {
          for (std::size_t c = 0; c < channels; ++c) {
            const float sample = in[std::size_t(at) * channels + c];
            const std::size_t i = std::size_t(x) * channels + c;
            low[i] = std::min(low[i], sample);
            high[i] = std::max(high[i], sample);
          }
        }
      }
    }
  });
  return range;
}

void clamp_to(const std::pair<Image, Image>& range, Image& enlarged) {
  const auto channels = std::size_t(enlarged.channels);
  parallel_for(std::size_t(enlarged.height), [&](std::size_t y) {
    const auto low = range.first.row(int(y / 2));
    const auto high = range.second.row(int(y / 2));
    const auto out = enlarged.row(int(y));
    for (std::size_t x = 0; x < std::size_t(enlarged.width); ++x) {
      for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t i = x / 2 * channels + c;
        out[x * channels + c] = std::clamp(out[x * channels + c], low[i], high[i]);
      }
    }
  });
}

void add(const Image& change, Image& image) {
  parallel_for(std::size_t(image.height), [&](std::size_t y) {
    const auto in = change.row(int(y));
    const auto out = image.row(int(y));
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += in[i];
  });
}

}  // namespace

Image enlarge_twofold(const Image& image) {
  const std::pair<Image, Image> range = range_around(image);
  Image result = interpolated(image);
  clamp_to(range, result);
  for (int i = 0; i < kCorrections; ++i) {
    add(interpolated(missed(image, result)), result);
    clamp_to(range, result);
  }
  return result;
}

}  // namespace knotreel::image
