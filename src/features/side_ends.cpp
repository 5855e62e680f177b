// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/side_ends.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "knotreel/base/parallel.h"

namespace knotreel::features {
namespace {

using Index = std::ptrdiff_t;

constexpr Index kLeastPoints = 9;          // of a straight stretch
constexpr double kStraightStretch = 0.05;  // px, root mean square distance of its points from a line
constexpr double kOff = 0.07;              // px from the line: what is not of the stretch any more
constexpr Index kUntold = 2;               // points at its ends that do not tell the line
constexpr Index kBend = 6;                 // points behind an end, up to where ...
constexpr double kLeastBend = 0.15;        // ... it has turned so much, radians
constexpr Index kCorner = 6;               // points between stretches that may hide a corner ...
constexpr double kBlunt = 1.05;            // ... of less than this turn, radians
constexpr Index kStep = 2;                 // points, between which turns are told
constexpr double kUneven = 2;              // times the mean turn that an arc turns by at most
constexpr Index kFromCorners = 4;          // points: what is nearer to a sharp corner belongs to it

/// A line through points, and how far they are from it.
struct Line {
  Vec2 point;
  Vec2 along;  ///< of a side: the way of the walk
  double rms = 0;

  double off(Vec2 p) const { return cross(along, p - point); }
};

/// Sums over points of a curve, so that the line through any of them in a row is found at once.
class Sums {
 public:
  explicit Sums(const std::vector<Vec2>& points) : points_(points) {
    at_.resize(points.size() + 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec2 p = points[i] - points.front();
      at_[i + 1] = {at_[i].sum + p, at_[i].xx + p.x * p.x, at_[i].xy + p.x * p.y, at_[i].yy + p.y * p.y};
    }
  }

  /// Through the points from first to last.
  Line line(Index first, Index last) const {
    const Moments& a = at_[static_cast<std::size_t>(first)];
    const Moments& b = at_[static_cast<std::size_t>(last) + 1];
    const auto n = static_cast<double>(last - first + 1);
    const Vec2 mean = (1 / n) * (b.sum - a.sum);
    const double xx = (b.xx - a.xx) / n - mean.x * mean.x;
    const double xy = (b.xy - a.xy) / n - mean.x * mean.y;
    const double yy = (b.yy - a.yy) / n - mean.y * mean.y;
    const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
    const double across = 0.5 * (xx + yy - std::hypot(xx - yy, 2 * xy));
    return {points_.front() + mean, {std::cos(angle), std::sin(angle)}, std::sqrt(std::max(0.0, across))};
  }

 private:
  struct Moments {
    Vec2 sum;
    double xx = 0, xy = 0, yy = 0;
  };
  const std::vector<Vec2>& points_;
  std::vector<Moments> at_;
};

/// The points of a chain, one after the other; a closed one begins a bend before the place where it bends
/// most, and goes round twice, so that each of its arcs has a stretch before and one behind.
struct Curve {
  std::vector<Vec2> points;
  std::vector<std::size_t> in_chain;
};

Curve curve_of(const Chain& chain) {
  const std::size_t n = chain.points.size();
  std::size_t start = 0;
  if (chain.closed) {
    double least = 2;
    for (std::size_t i = 0; i < n; ++i) {
      const Vec2 before = chain.points[i].on_curve() - chain.points[(i + n - kBend) % n].on_curve();
      const Vec2 behind = chain.points[(i + kBend) % n].on_curve() - chain.points[i].on_curve();
      const double cosine = dot(before, behind) / (norm(before) * norm(behind) + 1e-9);
      if (cosine < least) least = cosine, start = i;
    }
  }
  Curve curve;
  if (chain.closed) start += n - static_cast<std::size_t>(kBend) % n;
  for (std::size_t k = 0; k < (chain.closed ? 2 * n : n); ++k) {
    curve.in_chain.push_back((start + k) % n);
    curve.points.push_back(chain.points[curve.in_chain.back()].on_curve());
  }
  return curve;
}

class Marker {
 public:
  explicit Marker(Chain& chain) : chain_(chain), curve_(curve_of(chain)), sums_(curve_.points) {}

  void run() {
    const std::vector<Side> sides = find_sides();
    if (sides.empty()) return;
    // Of a closed chain, those behind the first one, and that one again.
    const Index end = chain_.closed ? sides[0].last + static_cast<Index>(chain_.points.size()) : size();
    for (std::size_t i = chain_.closed ? 1 : 0; i < sides.size() && sides[i].first < end; ++i) {
      const Side* const before = i > 0 ? &sides[i - 1] : nullptr;
      const Side* const behind = i + 1 < sides.size() ? &sides[i + 1] : nullptr;
      if (!before || !is_corner(*before, sides[i])) mark(sides[i].first, -1, sides[i].line);
      if (!behind || !is_corner(sides[i], *behind)) mark(sides[i].last, 1, sides[i].line);
      if (!behind || !is_arc(sides[i].last, behind->first)) continue;
      for (Index k = sides[i].last; k <= behind->first; ++k) point(k).rounded = true;
    }
  }

 private:
  /// A straight stretch.
  struct Side {
    Index first, last;
    Line line;
  };

  Index size() const { return static_cast<Index>(curve_.points.size()); }
  Vec2 at(Index i) const { return curve_.points[static_cast<std::size_t>(i)]; }
  ChainPoint& point(Index i) { return chain_.points[curve_.in_chain[static_cast<std::size_t>(i)]]; }

  std::vector<Side> find_sides() const {
    std::vector<Side> sides;
    for (Index first = 0; first + kLeastPoints <= size();) {
      Index last = first + kLeastPoints - 1;
      if (sums_.line(first, last).rms > kStraightStretch) {
        ++first;
        continue;
      }
      while (last + 1 < size() && sums_.line(first, last + 1).rms <= kStraightStretch) ++last;
      sides.push_back(side_within(first, last));
      first = std::max(last, sides.back().last);
    }
    return sides;
  }

  /// Bends at its ends look straight, too, for a while.
  Side side_within(Index first, Index last) const {
    const Line line = sums_.line(first + kUntold, last - kUntold);
    const auto end = [&](Index from, Index step) {
      Index i = from;
      while (i + step >= 0 && i + step < size() && std::abs(line.off(at(i + step))) <= kOff) i += step;
      return i;
    };
    Line walked = line;  // the line itself may point either way
    if (dot(line.along, at(last) - at(first)) < 0) walked.along = -1.0 * line.along;
    return {end(first + kUntold, -1), end(last - kUntold, 1), walked};
  }

  /// The detector makes bends of corners; a vertex on each side would hide one that was not found.
  bool is_corner(const Side& a, const Side& b) const {
    const double turn = std::acos(std::clamp(dot(a.line.along, b.line.along), -1.0, 1.0));
    return b.first - a.last <= kCorner && turn < kBlunt;
  }

  double turn(Index i, Index steps) const {
    const Vec2 before = at(i) - at(i - steps), behind = at(i + steps) - at(i);
    return angle_between(before, behind);
  }

  /// Whether the curve turns evenly between two points.
  bool is_arc(Index first, Index last) const {
    const Index n = last - first;
    if (n <= kCorner || first < kStep || last + kStep >= size()) return false;
    double sum = 0;
    double most = 0;
    for (Index i = first; i <= last; ++i) {
      const double t = turn(i, kStep);
      sum += t;
      most = std::max(most, std::abs(t));
    }
    return most <= kUneven * std::abs(sum) / static_cast<double>(n);
  }

  /// If the curve bends behind that end.
  void mark(Index i, Index step, const Line& line) {
    const Index behind = i + kBend * step;
    if (behind < 0 || behind >= size()) return;
    const Vec2 way = at(behind) - at(i);
    const double turn =
        std::atan2(std::abs(cross(line.along, way)), static_cast<double>(step) * dot(line.along, way));
    if (turn < kLeastBend) return;
    for (Index k = -kFromCorners; k <= kFromCorners; ++k) {
      if (i + k >= 0 && i + k < size() && point(i + k).corner) return;
    }
    point(i).preferred = true;
  }

  Chain& chain_;
  Curve curve_;
  Sums sums_;
};

}  // namespace

void prefer_side_ends(FeatureChains& chains) {
  parallel_for(chains.chains.size(), [&](std::size_t c) {
    Chain& chain = chains.chains[c];
    if (!chain.stepped && chain.points.size() > static_cast<std::size_t>(kLeastPoints + kBend))
      Marker(chain).run();
  });
}

}  // namespace knotreel::features
