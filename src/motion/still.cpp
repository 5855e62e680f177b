// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/still.h"

#include <algorithm>

#include "base/multiversion.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "motion/check_sizes.h"

namespace knotreel::motion {
namespace {

/// Differences are smoothed by (1 2 1) along both axes without dividing: squares are this much too large.
constexpr double kSmoothing = 16.0 * 16.0;

KNOTREEL_MULTIVERSION void add_difference(const std::uint8_t* a, const std::uint8_t* b, int weight,
                                          std::size_t n, int* out) {
  for (std::size_t x = 0; x < n; ++x) out[x] += weight * (int{a[x]} - int{b[x]});
}

/// Differences of row y and its neighbours, smoothed across rows; the border is continued by one value on
/// either side.
/// @param out width + 2 values.
void vertical_differences(const Luma& a, const Luma& b, int y, std::vector<int>& out) {
  const auto width = std::size_t(a.width);
  std::fill(out.begin(), out.end(), 0);
  for (int j = -1; j <= 1; ++j) {
    const auto start = std::size_t(std::clamp(y + j, 0, a.height - 1)) * width;
    add_difference(a.v.data() + start, b.v.data() + start, j == 0 ? 2 : 1, width, out.data() + 1);
  }
  out.front() = out[1];
  out.back() = out[width];
}

/// Sums of squared smoothed differences over all pixels above and to the left: entry (x, y) of (width + 1) x
/// (height + 1) is the sum over the pixels of the first x columns and y rows. Smoothing, since otherwise
/// sampling between noisy pixels, which averages them, would pass for an explanation.
std::vector<std::uint64_t> squared_difference_sums(const Luma& a, const Luma& b) {
  const auto width = std::size_t(a.width);
  const std::size_t stride = width + 1;
  std::vector<std::uint64_t> sums(stride * (std::size_t(a.height) + 1));
  std::vector<int> d(width + 2);
  for (int y = 0; y < a.height; ++y) {
    vertical_differences(a, b, y, d);
    const std::uint64_t* above = sums.data() + std::size_t(y) * stride;
    std::uint64_t* here = sums.data() + std::size_t(y + 1) * stride;
    std::uint64_t row = 0;
    for (std::size_t x = 0; x < width; ++x) {
      const int difference = d[x] + 2 * d[x + 1] + d[x + 2];
      row += std::uint64_t(difference * difference);
      here[x + 1] = above[x + 1] + row;
    }
  }
  return sums;
}

}  // namespace

StillTest::StillTest(const Luma& from, const Luma& to, const Luma& moved, const StillOptions& options)
    : options_(options), width_(from.width), height_(from.height) {
  if (options.radius < 0) throw Error(ErrorKind::kInvalidArgument, "the radius of a window is negative");
  check_sizes(from, to);
  check_sizes(from, moved);
  parallel_for(2, [&](std::size_t i) {
    (i == 0 ? standing_ : moving_) = squared_difference_sums(from, i == 0 ? to : moved);
  });
}

Stillness StillTest::at(Vec2 p) const {
  const int x = int(std::clamp(p.x, 0.0, double(width_ - 1)));
  const int y = int(std::clamp(p.y, 0.0, double(height_ - 1)));
  const auto left = std::size_t(std::max(0, x - options_.radius));
  const auto right = std::size_t(std::min(width_, x + options_.radius + 1));
  const std::size_t stride = std::size_t(width_) + 1;
  const std::size_t top = std::size_t(std::max(0, y - options_.radius)) * stride;
  const std::size_t bottom = std::size_t(std::min(height_, y + options_.radius + 1)) * stride;
  const double pixels = double((right - left) * ((bottom - top) / stride));
  const auto mean = [&](const std::vector<std::uint64_t>& sums) {
    const std::uint64_t sum =
        sums[bottom + right] + sums[top + left] - sums[bottom + left] - sums[top + right];
    return double(sum) / (kSmoothing * pixels);
  };
  const double standing = mean(standing_);
  const double moving = mean(moving_);
  if (standing > options_.ratio * moving + options_.slack) return Stillness::kMoves;
  return moving > options_.ratio * standing + options_.slack ? Stillness::kStays : Stillness::kEither;
}

std::vector<Stillness> still_points(std::span<const Vec2> points, std::span<const Vec2> motions,
                                    const Luma& from, const Luma& to, const Luma& moved,
                                    const StillOptions& options) {
  if (points.size() != motions.size()) {
    throw Error(ErrorKind::kInvalidArgument, "points and motions differ in number");
  }
  const StillTest test(from, to, moved, options);
  std::vector<Stillness> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    result[i] = motions[i] == Vec2{} ? Stillness::kStays : test.at(points[i]);
  }
  return result;
}

}  // namespace knotreel::motion
