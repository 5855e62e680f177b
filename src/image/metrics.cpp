// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include "base/lanes.h"
#include "base/multiversion.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/image/background.h"

namespace knotreel::image {
namespace {

/// Sums of one row; rows are added up in order, so that the number of threads does not show.
struct RowSums {
  double length = 0;        // of the colour error
  double squared = 0;       // colour error
  double squared_8bit = 0;  // rounded samples, all channels
};

[[gnu::always_inline]] inline int rounded(float sample) {
  return static_cast<int>(std::clamp(double{sample}, 0.0, 255.0) + 0.5);
}

constexpr std::size_t kLanes = 4;
using Lanes = LanesOf<double, kLanes>::Type;

double sum_of(const Lanes& v) {
  return (v[0] + v[2]) + (v[1] + v[3]);
}

/// Squared lengths of the colour errors of `count` pixels.
[[gnu::always_inline]] inline void squared_errors(const float* a, const float* b, std::size_t channels,
                                                  std::size_t colours, std::size_t count, Lanes& squared) {
  squared = Lanes{};
  for (std::size_t c = 0; c < colours; ++c) {
    Lanes difference{};
    for (std::size_t l = 0; l < count; ++l)
      difference[l] = double{a[l * channels + c]} - double{b[l * channels + c]};
    squared += difference * difference;
  }
}

KNOTREEL_MULTIVERSION
RowSums sum_row(std::span<const float> a, std::span<const float> b, std::size_t channels,
                std::size_t colours) {
  Lanes squared{};
  Lanes length{};
  const auto add = [&](std::size_t i, std::size_t count) __attribute__((always_inline)) {
    Lanes more;
    squared_errors(&a[i], &b[i], channels, colours, count, more);
    squared += more;
    for (std::size_t l = 0; l < kLanes; ++l) length[l] += std::sqrt(more[l]);
  };
  const std::size_t pixels = a.size() / channels;
  const std::size_t whole = pixels / kLanes * kLanes;
  for (std::size_t p = 0; p < whole; p += kLanes) add(p * channels, kLanes);
  if (whole < pixels) add(whole * channels, pixels - whole);
  std::int64_t squared_8bit = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const int difference = rounded(a[i]) - rounded(b[i]);
    squared_8bit += difference * difference;
  }
  return {sum_of(length), sum_of(squared), static_cast<double>(squared_8bit)};
}

/// One value per pixel, row-major, and room behind for a vector.
struct Plane {
  int width;
  int height;
  std::vector<double> values;
  double* row(int y) { return values.data() + std::size_t(y) * std::size_t(width); }
  const double* row(int y) const { return values.data() + std::size_t(y) * std::size_t(width); }
};

Plane luma(const Image& image) {
  Plane plane{image.width, image.height, std::vector<double>(image.pixel_count() + kLanes)};
  const bool grey = image.colour_channels() == 1;
  parallel_for(std::size_t(image.height), [&](std::size_t y) {
    const auto row = image.row(int(y));
    double* out = plane.row(int(y));
    for (std::size_t x = 0; x < std::size_t(image.width); ++x) {
      const float* p = row.data() + x * std::size_t(image.channels);
      out[x] = grey ? double{p[0]} : 0.299 * double{p[0]} + 0.587 * double{p[1]} + 0.114 * double{p[2]};
    }
  });
  return plane;
}

/// Weights of the Gaussian window, largest odd size up to 11 that fits, summing to 1.
std::vector<double> window(int available) {
  const int size = std::min(11, available - (available % 2 == 0 ? 1 : 0));
  std::vector<double> weights(std::size_t(std::max(size, 1)));
  const double centre = double(weights.size() - 1) / 2;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double distance = (double(i) - centre) / 1.5;
    weights[i] = std::exp(-0.5 * distance * distance);
  }
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// Weighted local sums of x, y, x^2 + y^2 and xy, each along a row: SSIM knows no more of the variances.
constexpr std::size_t kMoments = 4;

struct MomentRows {
  double* operator[](std::size_t k) { return values.data() + k * length; }
  /// Makes room for whole vectors from any column on.
  void resize(std::size_t width) {
    length = width + kLanes;
    values.resize(kMoments * length);
  }

  std::size_t length = 0;
  std::vector<double> values;
};

/// Mean SSIM of one row of windows: the vertical sums of the products first, then the horizontal ones.
/// @tparam N columns side by side; the result does not depend on it.
template <std::size_t N>
[[gnu::always_inline]] inline double ssim_row_by(const Plane& a, const Plane& b, int top,
                                                 const std::vector<double>& vertical,
                                                 const std::vector<double>& horizontal, MomentRows& columns) {
  using Side = LanesOf<double, N>;
  using Columns = typename Side::Type;
  const auto width = std::size_t(a.width);
  for (std::size_t x = 0; x < width; x += N) {
    Columns sums[kMoments] = {};
    for (std::size_t j = 0; j < vertical.size(); ++j) {
      Columns p;
      Columns q;
      Side::load(a.row(top + int(j)) + x, p);
      Side::load(b.row(top + int(j)) + x, q);
      const double weight = vertical[j];
      sums[0] += weight * p;
      sums[1] += weight * q;
      sums[2] += weight * (p * p + q * q);
      sums[3] += weight * (p * q);
    }
    for (std::size_t k = 0; k < kMoments; ++k) Side::store(sums[k], columns[k] + x);
  }
  const std::size_t windows = width - horizontal.size() + 1;
  constexpr double kC1 = (0.01 * 255) * (0.01 * 255);
  constexpr double kC2 = (0.03 * 255) * (0.03 * 255);
  double sum = 0;
  for (std::size_t x = 0; x < windows; x += N) {
    Columns m[kMoments] = {};
    for (std::size_t i = 0; i < horizontal.size(); ++i) {
      for (std::size_t k = 0; k < kMoments; ++k) {
        Columns from;
        Side::load(columns[k] + x + i, from);
        m[k] += horizontal[i] * from;
      }
    }
    const Columns product = m[0] * m[1];
    const Columns squares = m[0] * m[0] + m[1] * m[1];
    const Columns ssim =
        (2 * product + kC1) * (2 * (m[3] - product) + kC2) / ((squares + kC1) * (m[2] - squares + kC2));
    for (std::size_t l = 0; l < std::min(N, windows - x); ++l) sum += ssim[l];
  }
  return sum / double(windows);
}

using SsimRow = double (*)(const Plane&, const Plane&, int, const std::vector<double>&,
                           const std::vector<double>&, MomentRows&);

double ssim_row(const Plane& a, const Plane& b, int top, const std::vector<double>& vertical,
                const std::vector<double>& horizontal, MomentRows& columns) {
  return ssim_row_by<2>(a, b, top, vertical, horizontal, columns);
}

#ifdef KNOTREEL_WIDE
KNOTREEL_WIDE
double wide_ssim_row(const Plane& a, const Plane& b, int top, const std::vector<double>& vertical,
                     const std::vector<double>& horizontal, MomentRows& columns) {
  return ssim_row_by<4>(a, b, top, vertical, horizontal, columns);
}

const SsimRow kSsimRow = has_wide_vectors() ? wide_ssim_row : ssim_row;
#else
constexpr SsimRow kSsimRow = ssim_row;
#endif

double mean_ssim(const Plane& a, const Plane& b) {
  const std::vector<double> vertical = window(a.height);
  const std::vector<double> horizontal = window(a.width);
  std::vector<double> rows(std::size_t(a.height) - vertical.size() + 1);
  parallel_for(rows.size(), [&](std::size_t y) {
    thread_local MomentRows columns;
    columns.resize(std::size_t(a.width));
    rows[y] = kSsimRow(a, b, int(y), vertical, horizontal, columns);
  });
  return std::accumulate(rows.begin(), rows.end(), 0.0) / double(rows.size());
}

ImageMetrics compare_same_channels(const Image& a, const Image& b, Figures figures) {
  std::vector<RowSums> rows(std::size_t(a.height));
  parallel_for(rows.size(), [&](std::size_t y) {
    rows[y] =
        sum_row(a.row(int(y)), b.row(int(y)), std::size_t(a.channels), std::size_t(a.colour_channels()));
  });
  RowSums sums;
  for (const RowSums& row : rows) {
    sums.length += row.length;
    sums.squared += row.squared;
    sums.squared_8bit += row.squared_8bit;
  }
  const auto pixels = double(a.pixel_count());
  ImageMetrics metrics;
  metrics.mec = sums.length / pixels;
  metrics.rmse = std::sqrt(sums.squared / (pixels * a.colour_channels())) / 255;
  const double mean_squared = sums.squared_8bit / (pixels * a.channels);
  metrics.psnr =
      mean_squared == 0 ? std::numeric_limits<double>::infinity() : 10 * std::log10(255 * 255 / mean_squared);
  if (figures == Figures::kAll) metrics.ssim = mean_ssim(luma(a), luma(b));
  return metrics;
}

double mean_square_of(double psnr) {
  return std::pow(10.0, -psnr / 10);
}

ImageMetrics compare_on_grounds(const Image& a, const Image& b, Figures figures) {
  const auto on = [&](float level) {
    const Background ground{{level, level, level}};
    return compare_same_channels(on_background(a, ground), on_background(b, ground), figures);
  };
  const ImageMetrics black = on(0);
  const ImageMetrics white = on(255);
  const double square = (mean_square_of(black.psnr) + mean_square_of(white.psnr)) / 2;
  return {.mec = (black.mec + white.mec) / 2,
          .rmse = std::sqrt((black.rmse * black.rmse + white.rmse * white.rmse) / 2),
          .psnr = -10 * std::log10(square),
          .ssim = (black.ssim + white.ssim) / 2};
}

ImageMetrics compare_as_seen(const Image& a, const Image& b, Figures figures) {
  return a.has_alpha() ? compare_on_grounds(a, b, figures) : compare_same_channels(a, b, figures);
}

}  // namespace

ImageMetrics compare_images(const Image& a, const Image& b, Figures figures) {
  if (a.width != b.width || a.height != b.height) {
    throw Error(ErrorKind::kInvalidArgument, "the pictures differ in size: " + std::to_string(a.width) + "x" +
                                                 std::to_string(a.height) + " and " +
                                                 std::to_string(b.width) + "x" + std::to_string(b.height));
  }
  if (a.pixel_count() == 0) throw Error(ErrorKind::kInvalidArgument, "the pictures are empty");
  check_image(a);
  check_image(b);
  if (a.channels == b.channels) return compare_as_seen(a, b, figures);
  const int colours = std::max(a.colour_channels(), b.colour_channels());
  const int channels = colours + (a.has_alpha() || b.has_alpha() ? 1 : 0);
  return compare_as_seen(widen_channels(a, channels), widen_channels(b, channels), figures);
}

}  // namespace knotreel::image
