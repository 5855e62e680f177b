// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <optional>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/motion/flow.h"
#include "motion/bilinear.h"

namespace knotreel::motion {
namespace {

/// Fewer vectors than these have no median to speak of; at the largest window any will do.
constexpr std::size_t kEnoughVectors = 8;
constexpr int kFirstReach = 2;

using Mask = std::vector<std::uint8_t>;

int pixel_of(double coordinate, int count) {
  return int(std::clamp(coordinate, 0.0, double(count - 1)));
}

/// Bilinear between those of the four pixels around that are consistent; one of them must be.
Vec2 consistent_mean(Vec2 p, const Flow& flow, const Mask& mask) {
  const Cell cell = cell_at(float(p.x), float(p.y), flow.width, flow.height);
  const double x = double{cell.x};
  const double y = double{cell.y};
  const int pixels[4] = {cell.top_left, cell.top_right, cell.bottom_left, cell.bottom_right};
  const double weights[4] = {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y};
  Vec2 sum;
  double total = 0;
  for (int i = 0; i < 4; ++i) {
    const auto pixel = std::size_t(pixels[i]);
    if (mask[pixel] == 0) continue;
    sum = sum + weights[i] * Vec2{double{flow.xy[2 * pixel]}, double{flow.xy[2 * pixel + 1]}};
    total += weights[i];
  }
  return (1 / total) * sum;
}

/// The upper one of the two in the middle, if there are two.
double median(std::vector<float>& values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return double{*middle};
}

/// Median of the consistent vectors at most `reach` pixels from pixel (x, y); nothing if they are fewer than
/// `enough`.
std::optional<Vec2> window_median(int x, int y, int reach, std::size_t enough, const Flow& flow,
                                  const Mask& mask) {
  thread_local std::vector<float> dx;
  thread_local std::vector<float> dy;
  dx.clear();
  dy.clear();
  for (int j = std::max(0, y - reach); j <= std::min(flow.height - 1, y + reach); ++j) {
    for (int i = std::max(0, x - reach); i <= std::min(flow.width - 1, x + reach); ++i) {
      const std::size_t pixel = std::size_t(j) * std::size_t(flow.width) + std::size_t(i);
      if (mask[pixel] == 0) continue;
      dx.push_back(flow.xy[2 * pixel]);
      dy.push_back(flow.xy[2 * pixel + 1]);
    }
  }
  if (dx.size() < enough) return std::nullopt;
  return Vec2{median(dx), median(dy)};
}

Vec2 motion_of(Vec2 p, const Flow& flow, const Mask& mask) {
  const int x = pixel_of(p.x, flow.width);
  const int y = pixel_of(p.y, flow.height);
  if (mask[std::size_t(y) * std::size_t(flow.width) + std::size_t(x)] != 0) {
    return consistent_mean(p, flow, mask);
  }
  for (int reach = kFirstReach; reach <= kMotionReach; reach *= 2) {
    const std::size_t enough = reach == kMotionReach ? 1 : kEnoughVectors;
    if (const auto found = window_median(x, y, reach, enough, flow, mask)) return *found;
  }
  return {};
}

}  // namespace

std::vector<Vec2> point_motion(std::span<const Vec2> points, const Flow& forward,
                               const std::vector<std::uint8_t>& consistent) {
  if (consistent.empty() || 2 * consistent.size() != forward.xy.size()) {
    throw Error(ErrorKind::kInvalidArgument, "a flow and its consistent pixels differ in size");
  }
  std::vector<Vec2> motions(points.size());
  parallel_for(points.size(), [&](std::size_t i) { motions[i] = motion_of(points[i], forward, consistent); });
  return motions;
}

}  // namespace knotreel::motion
