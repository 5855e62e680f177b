#include "motion/histogram.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace knotreel::motion {
namespace {

constexpr std::size_t kLumaBins = 16;
constexpr std::size_t kChromaBins = 12;  // along either axis

/// Where a value of 0..255 falls between the centres of bins.
struct Place {
  std::size_t bin;  ///< the lower one; the next one exists
  double upper;     ///< share of the upper one
};

Place place_of(float value, std::size_t bins) {
  const float u = std::clamp(value, 0.0F, 255.0F) * float(bins - 1) / 255.0F;
  const std::size_t bin = std::min(std::size_t(u), bins - 2);
  return {bin, double{u - float(bin)}};
}

void add_luma(float luma, std::vector<double>& bins) {
  const Place place = place_of(luma, kLumaBins);
  bins[place.bin] += 1 - place.upper;
  bins[place.bin + 1] += place.upper;
}

void add_chroma(float blue, float red, std::vector<double>& bins) {
  const Place x = place_of(blue, kChromaBins);
  const Place y = place_of(red, kChromaBins);
  double* corner = bins.data() + y.bin * kChromaBins + x.bin;
  corner[0] += (1 - x.upper) * (1 - y.upper);
  corner[1] += x.upper * (1 - y.upper);
  corner[kChromaBins] += (1 - x.upper) * y.upper;
  corner[kChromaBins + 1] += x.upper * y.upper;
}

void normalise(std::vector<double>& bins) {
  const double sum = std::accumulate(bins.begin(), bins.end(), 0.0);
  for (double& bin : bins) bin /= sum;
}

double half_of_differences(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::abs(a[i] - b[i]);
  return 0.5 * sum;
}

}  // namespace

Histogram histogram_of(const image::Image& picture) {
  const bool grey = picture.colour_channels() == 1;
  Histogram histogram{std::vector<double>(kLumaBins),
                      std::vector<double>(grey ? 0 : kChromaBins * kChromaBins)};
  for (int y = 0; y < picture.height; y += 4) {
    const float* row = picture.row(y).data();
    for (int x = 0; x < picture.width; x += 2) {
      const float* p = row + std::size_t(x) * std::size_t(picture.channels);
      const float luma = grey ? p[0] : 0.299F * p[0] + 0.587F * p[1] + 0.114F * p[2];
      add_luma(luma, histogram.luma);
      if (grey) continue;
      // Twice the chroma of Rec. 601: few colours come near the ends of its range.
      add_chroma(127.5F + 1.128F * (p[2] - luma), 127.5F + 1.426F * (p[0] - luma), histogram.chroma);
    }
  }
  normalise(histogram.luma);
  normalise(histogram.chroma);
  return histogram;
}

double distance(const Histogram& a, const Histogram& b) {
  const double luma = half_of_differences(a.luma, b.luma);
  if (a.chroma.empty() || b.chroma.empty()) return luma;
  return 0.5 * (luma + half_of_differences(a.chroma, b.chroma));
}

}  // namespace knotreel::motion
