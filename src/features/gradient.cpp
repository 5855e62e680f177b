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
KNOTREEL_MULTIVERSION void smooth_along(const float* padded, std::size_t width, const float* weights,
                                        std::size_t radius, float* out) {
  for (std::size_t x = 0; x < width; ++x) out[x] = weights[0] * padded[x + radius];
  for (std::size_t k = 1; k <= radius; ++k) {
    for (std::size_t x = 0; x < width; ++x) {
      out[x] += weights[k] * (padded[x + radius - k] + padded[x + radius + k]);
    }
  }
}

KNOTREEL_MULTIVERSION void add_pair(const float* above, const float* below, std::size_t width, float weight,
                                    float* out) {
  for (std::size_t x = 0; x < width; ++x) out[x] += weight * (above[x] + below[x]);
}

/// Gradients of one channel in one row. `left` is the row moved by one, `right` likewise; the strongest
/// channel so far is in gx, gy, magnitude and channel.
KNOTREEL_MULTIVERSION void keep_strongest(const float* left, const float* right, const float* above,
                                          const float* below, std::size_t width, std::uint8_t c,
                                          bool euclidean, float* gx, float* gy, float* magnitude,
                                          std::uint8_t* channel) {
  for (std::size_t x = 0; x < width; ++x) {
    const float dx = 0.5F * (right[x] - left[x]);
    const float dy = 0.5F * (below[x] - above[x]);
    const float ax = dx < 0 ? -dx : dx;
    const float ay = dy < 0 ? -dy : dy;
    const float m = euclidean ? std::sqrt(dx * dx + dy * dy) : (ax > ay ? ax : ay);
    const bool stronger = c == 0 || m > magnitude[x];
    gx[x] = stronger ? dx : gx[x];
    gy[x] = stronger ? dy : gy[x];
    channel[x] = stronger ? c : channel[x];
    magnitude[x] = stronger ? m : magnitude[x];
  }
}

/// Rows that one task works on: enough that scratch memory and scheduling do not count.
constexpr int kBand = 32;

void for_bands(int height, const std::function<void(int, int)>& body) {
  const int bands = (height + kBand - 1) / kBand;
  parallel_for(std::size_t(bands), [&](std::size_t band) {
    const int begin = int(band) * kBand;
    body(begin, std::min(height, begin + kBand));
  });
}

}  // namespace

GradientField make_gradient_field(const image::Image& image, const DetectOptions& options) {
  GradientField field{image.width, image.height, image.channels, {}, {}, {}, {}, {}, {}};
  const std::size_t n = field.pixels();
  const auto width = std::size_t(image.width);
  const auto planes = std::size_t(image.channels);
  const std::vector<float> weights = gaussian(options.smoothing);
  const std::size_t radius = weights.size() - 1;
  field.raw.resize(planes * n);
  field.smooth.resize(planes * n);
  std::vector<float> along(planes * n);

  for_bands(image.height, [&](int begin, int end) {
    std::vector<float> padded(width + 2 * radius);
    for (int y = begin; y < end; ++y) {
      for (std::size_t c = 0; c < planes; ++c) {
        float* raw = field.raw.data() + c * n + std::size_t(y) * width;
        take_channel(image, y, int(c), raw);
        std::fill_n(padded.begin(), radius, raw[0]);
        std::copy_n(raw, width, padded.begin() + std::ptrdiff_t(radius));
        std::fill_n(padded.begin() + std::ptrdiff_t(radius + width), radius, raw[width - 1]);
        smooth_along(padded.data(), width, weights.data(), radius,
                     along.data() + c * n + std::size_t(y) * width);
      }
    }
  });

  const auto clamped = [&](int y) { return std::size_t(std::clamp(y, 0, image.height - 1)) * width; };
  for_bands(image.height, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (std::size_t c = 0; c < planes; ++c) {
        const float* plane = along.data() + c * n;
        float* out = field.smooth.data() + c * n + clamped(y);
        std::fill_n(out, width, 0.0F);
        add_pair(plane + clamped(y), plane + clamped(y), width, 0.5F * weights[0], out);
        for (int k = 1; k <= int(radius); ++k) {
          add_pair(plane + clamped(y - k), plane + clamped(y + k), width, weights[std::size_t(k)], out);
        }
      }
    }
  });

  field.gx.resize(n);
  field.gy.resize(n);
  field.magnitude.resize(n);
  field.channel.resize(n);
  for_bands(image.height, [&](int begin, int end) {
    std::vector<float> padded(width + 2);
    for (int y = begin; y < end; ++y) {
      for (std::size_t c = 0; c < planes; ++c) {
        const float* plane = field.smooth.data() + c * n;
        const float* row = plane + clamped(y);
        std::copy_n(row, width, padded.begin() + 1);
        padded.front() = row[0];
        padded.back() = row[width - 1];
        const std::size_t i = clamped(y);
        keep_strongest(padded.data(), padded.data() + 2, plane + clamped(y - 1), plane + clamped(y + 1),
                       width, std::uint8_t(c), options.euclidean_magnitude, field.gx.data() + i,
                       field.gy.data() + i, field.magnitude.data() + i, field.channel.data() + i);
      }
    }
  });
  return field;
}

}  // namespace knotreel::features
