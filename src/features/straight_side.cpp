#include "features/straight_side.h"

#include <algorithm>
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

StraightSide line_through(const ChainWalk& walk, std::size_t gap, std::size_t count) {
  StraightSide side{gap, count, {}, {}};
  for (std::size_t k = 0; k < count; ++k) side.point = side.point + walk.at(gap + k);
  side.point = (1.0 / double(count)) * side.point;
  double xx = 0;
  double xy = 0;
  double yy = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec2 d = walk.at(gap + k) - side.point;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  side.away = {std::cos(angle), std::sin(angle)};
  if (dot(side.away, walk.at(gap + count - 1) - walk.at(gap)) < 0) side.away = -1.0 * side.away;
  return side;
}

bool is_straight(const ChainWalk& walk, const StraightSide& side, double scale) {
  double sum = 0;
  for (std::size_t k = 0; k < side.count; ++k)
    sum += square(cross(side.away, walk.at(side.gap + k) - side.point));
  return sum <= square(scale * kStraight) * double(side.count);
}

/// The longest with that gap.
std::optional<StraightSide> longest_side(const ChainWalk& walk, std::size_t gap, double scale) {
  std::optional<StraightSide> longest;
  for (std::size_t count = kLeastCount; count <= kMostCount && gap + count <= walk.steps() + 1; ++count) {
    const StraightSide side = line_through(walk, gap, count);
    if (!is_straight(walk, side, scale)) break;
    longest = side;
  }
  return longest;
}

}  // namespace

std::optional<StraightSide> straight_side(const ChainWalk& walk, double scale) {
  std::optional<StraightSide> best;
  for (std::size_t gap = kLeastGap; gap <= kMostGap; ++gap) {
    const std::optional<StraightSide> side = longest_side(walk, gap, scale);
    if (side && (!best || side->count > best->count)) best = side;
  }
  return best;
}

double turn_of_arc(const StraightSide& a, const StraightSide& b, double scale) {
  constexpr double kRmsOfSagitta = 0.3;
  const double chord = double(std::min(a.count, b.count)) - 1;
  const double radius = chord * chord * kRmsOfSagitta / (8 * scale * kStraight);
  return (double(a.gap + b.gap) + 0.5 * double(a.count + b.count)) / radius;
}

}  // namespace knotreel::features
