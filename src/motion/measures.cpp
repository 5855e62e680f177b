// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/measures.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "motion/bilinear.h"
#include "motion/check_sizes.h"

namespace knotreel::motion {
namespace {

using image::Image;

/// A sum of absolute values and how many there are.
struct Sum {
  double total = 0;
  std::size_t count = 0;
};

double mean(const std::vector<Sum>& rows) {
  Sum sum;
  for (const Sum& row : rows) sum = {sum.total + row.total, sum.count + row.count};
  return sum.count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum.total / double(sum.count);
}

/// Mean of the figures that there are.
double mean(const std::vector<double>& figures) {
  Sum sum;
  for (const double figure : figures) {
    if (!std::isnan(figure)) sum = {sum.total + figure, sum.count + 1};
  }
  return sum.count == 0 ? 0 : sum.total / double(sum.count);
}

Image error_of(const Image& reference, const Image& result) {
  Image error{result.width, result.height, result.channels, std::vector<float>(result.samples.size())};
  parallel_for(std::size_t(result.height), [&](std::size_t y) {
    const float* p = reference.row(int(y)).data();
    const float* q = result.row(int(y)).data();
    float* out = error.row(int(y)).data();
    for (std::size_t i = 0; i < result.row_size(); ++i) out[i] = q[i] - p[i];
    if (!result.has_alpha()) return;
    const auto stride = std::size_t(result.channels);
    for (std::size_t i = 0; i < result.row_size(); ++i) {
      const std::size_t alpha = i - i % stride + stride - 1;
      if (i != alpha) out[i] = (q[i] * q[alpha] - p[i] * p[alpha]) / 255;
    }
  });
  return error;
}

double change(const Image& before, const Image& now) {
  std::vector<Sum> rows(std::size_t(now.height));
  parallel_for(rows.size(), [&](std::size_t y) {
    const float* p = before.row(int(y)).data();
    const float* q = now.row(int(y)).data();
    double total = 0;
    for (std::size_t i = 0; i < now.row_size(); ++i) total += double{std::abs(q[i] - p[i])};
    rows[y] = {total, now.row_size()};
  });
  return mean(rows);
}

/// Sampling is linear, so the difference may be taken before it: the errors are all that is needed.
double change_along(const Image& before, const Image& now, const Flow& flow,
                    const std::vector<std::uint8_t>* consistent) {
  const auto width = std::size_t(now.width);
  const auto channels = std::size_t(now.channels);
  std::vector<Sum> rows(std::size_t(now.height));
  parallel_for(rows.size(), [&](std::size_t y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t pixel = y * width + x;
      if (consistent != nullptr && (*consistent)[pixel] == 0) continue;
      const float there_x = float(x) + 0.5F + flow.xy[2 * pixel];
      const float there_y = float(y) + 0.5F + flow.xy[2 * pixel + 1];
      const bool inside =
          there_x >= 0 && there_y >= 0 && there_x <= float(now.width) && there_y <= float(now.height);
      if (!inside) continue;
      const Cell cell = cell_at(there_x, there_y, now.width, now.height);
      for (std::size_t c = 0; c < channels; ++c) {
        const float there = cell.sample(now.samples.data() + c, now.channels);
        rows[y].total += double{std::abs(there - before.samples[pixel * channels + c])};
      }
      rows[y].count += channels;
    }
  });
  return mean(rows);
}

void check_channels(const Image& a, const Image& b) {
  if (a.channels == b.channels) return;
  throw Error(ErrorKind::kInvalidArgument, "the pictures have " + std::to_string(a.channels) + " and " +
                                               std::to_string(b.channels) + " channels, and need as many");
}

}  // namespace

void FlickerMeter::add(const Image& reference, const Image& result, const Flow* flow,
                       const std::vector<std::uint8_t>* consistent) {
  check_sizes(reference, result);
  check_channels(reference, result);
  if (flow != nullptr) check_sizes(*flow, result);
  if (consistent != nullptr && consistent->size() != result.pixel_count()) {
    throw Error(ErrorKind::kInvalidArgument, "a picture and its consistent pixels differ in size");
  }
  const bool first = error_before_.samples.empty();
  if (!first) {
    check_sizes(error_before_, result);
    check_channels(error_before_, result);
  }
  Image error = error_of(reference, result);
  if (!first) {
    plain_.push_back(change(error_before_, error));
    warped_.push_back(flow == nullptr ? std::numeric_limits<double>::quiet_NaN()
                                      : change_along(error_before_, error, *flow, consistent));
  }
  error_before_ = std::move(error);
}

double FlickerMeter::flicker() const {
  return mean(plain_);
}

double FlickerMeter::warped_flicker() const {
  return mean(warped_);
}

}  // namespace knotreel::motion
