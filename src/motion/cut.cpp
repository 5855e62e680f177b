#include "knotreel/motion/cut.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/motion/warp.h"
#include "motion/check_sizes.h"
#include "motion/histogram.h"

namespace knotreel::motion {
namespace {

/// Side of the blocks whose texture is compared: texture is what is left when the mean of a block is taken
/// off.
constexpr std::size_t kBlock = 16;

/// Variance, in squared levels, that counts as equal texture in every block, so that flat pictures are alike
/// and noise of a few levels says little.
constexpr double kFlat = 8;

/// Over the blocks of one band of rows.
struct BandSums {
  double difference = 0;  ///< absolute, over pixels
  double covariance = 0;  ///< of the two pictures, times pixels, over blocks
  double contrast = 0;    ///< product of the standard deviations, times pixels, over blocks
};

/// First and second moments of two pictures in a block; all are exact.
struct BlockSums {
  std::int64_t a = 0, b = 0, aa = 0, bb = 0, ab = 0, difference = 0, pixels = 0;
};

BlockSums sum_block(const Luma& a, const Luma& b, std::size_t left, std::size_t top) {
  const auto width = std::size_t(a.width);
  const std::size_t right = std::min(width, left + kBlock);
  const std::size_t bottom = std::min(std::size_t(a.height), top + kBlock);
  BlockSums sums;
  sums.pixels = std::int64_t((right - left) * (bottom - top));
  for (std::size_t y = top; y < bottom; ++y) {
    for (std::size_t i = y * width + left; i < y * width + right; ++i) {
      const int p = a.v[i];
      const int q = b.v[i];
      sums.a += p;
      sums.b += q;
      sums.aa += p * p;
      sums.bb += q * q;
      sums.ab += p * q;
      sums.difference += std::abs(p - q);
    }
  }
  return sums;
}

void add_block(const BlockSums& block, BandSums& band) {
  const auto n = double(block.pixels);
  const auto central = [n](std::int64_t product, std::int64_t p, std::int64_t q) {
    return double(product) - double(p) * double(q) / n;
  };
  const double variances = central(block.aa, block.a, block.a) * central(block.bb, block.b, block.b);
  band.difference += double(block.difference);
  band.covariance += central(block.ab, block.a, block.b) + n * kFlat;
  band.contrast += std::sqrt(std::max(0.0, variances)) + n * kFlat;
}

BandSums compare(const Luma& a, const Luma& b) {
  std::vector<BandSums> bands((std::size_t(a.height) + kBlock - 1) / kBlock);
  parallel_for(bands.size(), [&](std::size_t band) {
    for (std::size_t left = 0; left < std::size_t(a.width); left += kBlock) {
      add_block(sum_block(a, b, left, band * kBlock), bands[band]);
    }
  });
  BandSums sums;
  for (const BandSums& band : bands) {
    sums.difference += band.difference;
    sums.covariance += band.covariance;
    sums.contrast += band.contrast;
  }
  return sums;
}

}  // namespace

CutMeasure measure_change(const image::Image& before, const image::Image& now, const Flow& forward,
                          const std::vector<std::uint8_t>& consistent) {
  check_sizes(before, now);
  return measure_change(before, now, luma_of(before), luma_of(now), forward, consistent);
}

CutMeasure measure_change(const image::Image& before, const image::Image& now, const Luma& luma_before,
                          const Luma& luma_now, const Flow& forward,
                          const std::vector<std::uint8_t>& consistent) {
  check_sizes(before, now);
  check_sizes(before, luma_before);
  check_sizes(now, luma_now);
  check_sizes(before, forward);
  if (consistent.size() != before.pixel_count()) {
    throw Error(ErrorKind::kInvalidArgument, "a flow and its consistent pixels differ in size");
  }
  const auto pixels = double(before.pixel_count());
  const BandSums sums = compare(luma_before, warp(luma_now, forward));
  CutMeasure measure;
  measure.histogram = distance(histogram_of(before), histogram_of(now));
  measure.residual = sums.difference / pixels;
  measure.unmatched =
      1 - double(std::accumulate(consistent.begin(), consistent.end(), std::size_t{0})) / pixels;
  measure.unlike = 1 - std::clamp(sums.covariance / sums.contrast, 0.0, 1.0);
  return measure;
}

double cut_score(const CutMeasure& measure) {
  return 0.5 * (measure.unmatched + measure.unlike);
}

bool is_cut(const CutMeasure& measure, const CutOptions& options) {
  return cut_score(measure) >= options.threshold;
}

}  // namespace knotreel::motion
