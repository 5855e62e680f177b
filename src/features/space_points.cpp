// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/space_points.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace knotreel::features {
namespace {

constexpr double kCrowded = 0.5;  // pixels from a corner or an end

/// On the curve, or between the positions, where the vertices of polylines are.
double distance(const ChainPoint& a, const ChainPoint& b) {
  return std::min(norm(b.on_curve() - a.on_curve()), norm(b.position - a.position));
}

bool is_too_near(const Chain& chain, std::size_t i, double least) {
  if (!chain.closed && i + 1 == chain.points.size()) return false;
  return distance(chain.points[i], chain.points[(i + 1) % chain.points.size()]) < least;
}

/// Puts a point part of the way from one to another, on the curve and as a position.
void put_between(const ChainPoint& from, const ChainPoint& to, double share, ChainPoint& p) {
  const Vec2 on_curve = from.on_curve() + share * (to.on_curve() - from.on_curve());
  p.move_to(from.position + share * (to.position - from.position));
  p.beyond = on_curve - p.position;
}

/// From a point that stays, one step after the other, to the next one that is far enough, or to none if there
/// is another one before that has to stay. @return whether there is one.
bool space_from(std::vector<ChainPoint>& points, std::size_t fixed, std::ptrdiff_t step, bool closed,
                double least) {
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  const auto index = [&](std::ptrdiff_t k) {
    const std::ptrdiff_t i = static_cast<std::ptrdiff_t>(fixed) + k * step;
    return closed ? (i % count + count) % count : i;
  };
  const auto at = [&](std::ptrdiff_t k) -> ChainPoint& { return points[static_cast<std::size_t>(index(k))]; };
  const ChainPoint& from = points[fixed];
  std::ptrdiff_t first = 1;
  for (;; ++first) {
    const std::ptrdiff_t i = index(first);
    if (first >= count || i < 0 || i >= count) return false;
    ChainPoint& p = at(first);
    if (distance(from, p) >= std::max(kCrowded, static_cast<double>(first) * least)) break;
    if (!closed && (i == 0 || i + 1 == count)) return false;
    if (norm(p.on_curve() - from.on_curve()) < kCrowded) p.corner = false;  // it is the same one
    if (p.corner) return false;
  }
  for (std::ptrdiff_t k = 1; k < first; ++k)
    put_between(from, at(first), static_cast<double>(k) / static_cast<double>(first), at(k));
  return true;
}

}  // namespace

void space_points(FeatureChains& chains, double least) {
  for (Chain& chain : chains.chains) {
    for (std::size_t i = 0; i < chain.points.size(); ++i) {
      const bool is_end = !chain.closed && (i == 0 || i + 1 == chain.points.size());
      if (!is_end && !chain.points[i].corner) continue;
      space_from(chain.points, i, 1, chain.closed, least);
      space_from(chain.points, i, -1, chain.closed, least);
    }
    for (std::size_t i = 0; i < chain.points.size(); ++i) {
      if (!is_too_near(chain, i, least) || space_from(chain.points, i, 1, chain.closed, least)) continue;
      space_from(chain.points, (i + 1) % chain.points.size(), -1, chain.closed, least);
    }
  }
}

}  // namespace knotreel::features
