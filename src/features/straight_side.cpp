// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/straight_side.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace knotreel::features {
namespace {

constexpr std::size_t kLeastCount = 4;
constexpr std::size_t kMostCount = 14;
constexpr std::size_t kLeastGap = 2;
constexpr std::size_t kMostGap = 5;
constexpr double kStraight = 0.05;  // px of the picture, root mean square distance from the line

double square(double x) {
  return x * x;
}

/// The first points of a walk, as many as may matter.
struct Points {
  std::array<Vec2, kMostGap + kMostCount> at;
  std::size_t count = 0;

  explicit Points(const ChainWalk& walk) : count(std::min(at.size(), walk.steps() + 1)) {
    for (std::size_t k = 0; k < count; ++k) at[k] = walk.at(k);
  }
};

/// Of points, relative to one of them; the line that fits them best need not be known for how straight they
/// are.
struct Moments {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;

  void add(Vec2 p) {
    n += 1;
    x += p.x;
    y += p.y;
    xx += p.x * p.x;
    xy += p.x * p.y;
    yy += p.y * p.y;
  }
  /// Mean square distance from that line.
  double across() const {
    const double a = xx / n - square(x / n);
    const double b = xy / n - x / n * (y / n);
    const double c = yy / n - square(y / n);
    return 0.5 * (a + c - std::sqrt(square(a - c) + square(2 * b)));
  }
};

/// Points of the longest straight stretch with that gap, or 0.
std::size_t longest_count(const Points& points, std::size_t gap, double scale) {
  std::size_t longest = 0;
  Moments moments;
  for (std::size_t k = 0; k < kMostCount && gap + k < points.count; ++k) {
    moments.add(points.at[gap + k] - points.at[gap]);
    if (k + 1 < kLeastCount) continue;
    if (moments.across() > square(scale * kStraight)) break;
    longest = k + 1;
  }
  return longest;
}

StraightSide line_through(const Points& points, std::size_t gap, std::size_t count) {
  StraightSide side{gap, count, {}, {}};
  for (std::size_t k = 0; k < count; ++k) side.point = side.point + points.at[gap + k];
  side.point = (1.0 / double(count)) * side.point;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec2 d = points.at[gap + k] - side.point;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  side.away = {std::cos(angle), std::sin(angle)};
  if (dot(side.away, points.at[gap + count - 1] - points.at[gap]) < 0) side.away = -1.0 * side.away;
  return side;
}

}  // namespace

std::optional<StraightSide> straight_side(const ChainWalk& walk, double scale) {
  const Points points(walk);
  std::size_t best_gap = 0;
  std::size_t best_count = 0;
  for (std::size_t gap = kLeastGap; gap <= kMostGap; ++gap) {
    const std::size_t count = longest_count(points, gap, scale);
    if (count > best_count) best_gap = gap, best_count = count;
  }
  if (best_count == 0) return std::nullopt;
  return line_through(points, best_gap, best_count);
}

double turn_of_arc(const StraightSide& a, const StraightSide& b, double scale) {
  constexpr double kRmsOfSagitta = 0.3;
  const double chord = double(std::min(a.count, b.count)) - 1;
  const double radius = chord * chord * kRmsOfSagitta / (8 * scale * kStraight);
  return (double(a.gap + b.gap) + 0.5 * double(a.count + b.count)) / radius;
}

}  // namespace knotreel::features
