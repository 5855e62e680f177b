// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/gradient.h"

#include <algorithm>
#include <cmath>

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"

namespace knotreel::features {
namespace {

/// weights[k] of the pixels at distance k; the sum over both sides is 1 up to rounding.
std::vector<float> gaussian(double sigma) {
  if (sigma <= 0) return {1.0F};
  std::vector<double> weights(std::size_t(std::ceil(3 * sigma)) + 1);
  double sum = 0;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    weights[k] = std::exp(-0.5 * double(k * k) / (sigma * sigma));
    sum += (k == 0 ? 1 : 2) * weights[k];
  }
  std::vector<float> result;
  for (const double weight : weights) result.push_back(float(weight / sum));
  return result;
}

/// One channel of a row, colours times alpha.
void take_channel(const image::Image& image, int y, int c, float* out) {
  const auto row = image.row(y);
  const auto step = std::size_t(image.channels);
  const auto width = std::size_t(image.width);
  const bool weighted = image.has_alpha() && c < image.colour_channels();
  for (std::size_t x = 0; x < width; ++x) {
    const float* sample = row.data() + x * step;
    out[x] = weighted ? sample[c] * (sample[step - 1] / 255.0F) : sample[c];
  }
}

// Opposite neighbours are added first, so that a mirrored picture has mirrored sums to the last bit.
KNOTREEL_MULTIVERSION void smooth_along(const float* __restrict padded, std::size_t width,
                                        const float* weights, std::size_t radius, float* __restrict out) {
  for (std::size_t x = 0; x < width; ++x) out[x] = weights[0] * padded[x + radius];
  for (std::size_t k = 1; k <= radius; ++k) {
    for (std::size_t x = 0; x < width; ++x) {
      out[x] += weights[k] * (padded[x + radius - k] + padded[x + radius + k]);
    }
  }
}

KNOTREEL_MULTIVERSION void add_pair(const float* above, const float* below, std::size_t width, float weight,
                                    float* __restrict out) {
  for (std::size_t x = 0; x < width; ++x) out[x] += weight * (above[x] + below[x]);
}

/// Magnitudes of one channel in one row; `left` is the row moved by one, `right` likewise. Keeps the
/// strongest channel so far.
KNOTREEL_MULTIVERSION void keep_strongest(const float* __restrict left, const float* __restrict right,
                                          const float* __restrict above, const float* __restrict below,
                                          std::size_t width, std::uint8_t c, bool euclidean,
                                          float* __restrict magnitude, std::uint8_t* __restrict channel) {
  for (std::size_t x = 0; x < width; ++x) {
    const float dx = 0.5F * (right[x] - left[x]);
    const float dy = 0.5F * (below[x] - above[x]);
    const float ax = dx < 0 ? -dx : dx;
    const float ay = dy < 0 ? -dy : dy;
    const float largest = ax > ay ? ax : ay;
    const float m = euclidean ? std::sqrt(dx * dx + dy * dy) : largest;
    const bool stronger = c == 0 || m > magnitude[x];
    channel[x] = stronger ? c : channel[x];
    magnitude[x] = stronger ? m : magnitude[x];
  }
}

/// Rows that one task works on: enough that scratch memory and scheduling do not count.
constexpr int kBand = 64;

void for_bands(int height, const std::function<void(int, int)>& body) {
  const int bands = (height + kBand - 1) / kBand;
  parallel_for(std::size_t(bands), [&](std::size_t band) {
    const int begin = int(band) * kBand;
    body(begin, std::min(height, begin + kBand));
  });
}

}  // namespace

Vec2 GradientField::gradient(int x, int y) const {
  const float* s = plane(channel[at(x, y)]);
  const double left{s[at(std::max(x - 1, 0), y)]};
  const double right{s[at(std::min(x + 1, width - 1), y)]};
  const double above{s[at(x, std::max(y - 1, 0))]};
  const double below{s[at(x, std::min(y + 1, height - 1))]};
  return {0.5 * (right - left), 0.5 * (below - above)};
}

double GradientField::raw(int x, int y, int c) const {
  const bool weighted = image->has_alpha() && c < image->colour_channels();
  return weighted ? double{image->at(x, y, c) * (image->at(x, y, image->channels - 1) / 255.0F)}
                  : double{image->at(x, y, c)};
}

namespace {

/// Smooths the rows [begin, end) of one channel. The rows around them are smoothed along once more for each
/// band, which costs less than a picture in between that does not fit into the cache.
void smooth_band(const image::Image& image, int c, int begin, int end, const std::vector<float>& weights,
                 float* plane) {
  const auto width = std::size_t(image.width);
  const int radius = int(weights.size()) - 1;
  const std::size_t margin = weights.size() - 1;
  const int top = std::max(0, begin - radius);
  const int bottom = std::min(image.height, end + radius);
  std::vector<float> padded(width + 2 * margin);
  std::vector<float> along(std::size_t(bottom - top) * width);
  for (int y = top; y < bottom; ++y) {
    float* middle = padded.data() + margin;
    take_channel(image, y, c, middle);
    std::fill_n(padded.data(), margin, middle[0]);
    std::fill_n(middle + width, margin, middle[width - 1]);
    smooth_along(padded.data(), width, weights.data(), margin, along.data() + std::size_t(y - top) * width);
  }
  const auto row = [&](int y) {
    return along.data() + std::size_t(std::clamp(y, 0, image.height - 1) - top) * width;
  };
  for (int y = begin; y < end; ++y) {
    float* out = plane + std::size_t(y) * width;
    add_pair(row(y), row(y), width, 0.5F * weights[0], out);
    for (int k = 1; k <= radius; ++k) add_pair(row(y - k), row(y + k), width, weights[std::size_t(k)], out);
  }
}

void measure_rows(GradientField& field, int begin, int end, int channels, bool euclidean) {
  const auto width = std::size_t(field.width);
  std::vector<float> padded(width + 2);
  for (int y = begin; y < end; ++y) {
    for (int c = 0; c < channels; ++c) {
      const float* row = field.plane(c) + field.at(0, y);
      std::copy_n(row, width, padded.begin() + 1);
      padded.front() = row[0];
      padded.back() = row[width - 1];
      const float* above = field.plane(c) + field.at(0, std::max(y - 1, 0));
      const float* below = field.plane(c) + field.at(0, std::min(y + 1, field.height - 1));
      keep_strongest(padded.data(), padded.data() + 2, above, below, width, std::uint8_t(c), euclidean,
                     field.magnitude.data() + field.at(0, y), field.channel.data() + field.at(0, y));
    }
  }
}

}  // namespace

GradientField make_gradient_field(const image::Image& image, const DetectOptions& options) {
  GradientField field;
  field.image = &image;
  field.width = field.whole_width = image.width;
  field.height = field.whole_height = image.height;
  const std::size_t n = field.pixels();
  const std::vector<float> weights = gaussian(options.smoothing);
  field.smooth.resize(std::size_t(image.channels) * n);
  for_bands(image.height, [&](int begin, int end) {
    for (int c = 0; c < image.channels; ++c) {
      smooth_band(image, c, begin, end, weights, field.smooth.data() + std::size_t(c) * n);
    }
  });
  field.magnitude.resize(n);
  field.channel.resize(n);
  for_bands(image.height, [&](int begin, int end) {
    measure_rows(field, begin, end, image.channels, options.euclidean_magnitude);
  });
  return field;
}

int reach_of_gradients(const DetectOptions& options) {
  return int(gaussian(options.smoothing).size());
}

}  // namespace knotreel::features
