#include "knotreel/features/space_points.h"

#include <cstddef>
#include <vector>

namespace knotreel::features {
namespace {

constexpr double kCrowded = 0.5;   // pixels from a corner or an end
constexpr double kTooNear = 0.25;  // from any point to the next

bool is_too_near(const Chain& chain, std::size_t i) {
  if (!chain.closed && i + 1 == chain.points.size()) return false;
  const Vec2 next = chain.points[(i + 1) % chain.points.size()].on_curve();
  return norm(next - chain.points[i].on_curve()) < kTooNear;
}

/// From a point that stays, one step after the other; on until the next point that stays.
void space_from(std::vector<ChainPoint>& points, std::size_t fixed, std::ptrdiff_t step, bool closed) {
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  const auto at = [&](std::ptrdiff_t k) -> ChainPoint* {
    std::ptrdiff_t i = static_cast<std::ptrdiff_t>(fixed) + k * step;
    if (closed) i = (i % count + count) % count;
    return i < 0 || i >= count ? nullptr : &points[static_cast<std::size_t>(i)];
  };
  const Vec2 from = points[fixed].on_curve();
  std::ptrdiff_t first = 1;  // that is far enough
  for (; first < count; ++first) {
    const ChainPoint* const p = at(first);
    const bool is_last = !closed && (p == nullptr || at(first + 1) == nullptr);
    if (p == nullptr || is_last || p->corner) return;
    if (norm(p->on_curve() - from) >= kCrowded) break;
  }
  if (first == count) return;
  const Vec2 way = at(first)->on_curve() - from;
  for (std::ptrdiff_t k = 1; k < first; ++k)
    at(k)->move_to(from + (static_cast<double>(k) / static_cast<double>(first)) * way);
}

}  // namespace

void space_points(FeatureChains& chains) {
  for (Chain& chain : chains.chains) {
    for (std::size_t i = 0; i < chain.points.size(); ++i) {
      const bool is_end = !chain.closed && (i == 0 || i + 1 == chain.points.size());
      if (!is_end && !chain.points[i].corner) continue;
      space_from(chain.points, i, 1, chain.closed);
      space_from(chain.points, i, -1, chain.closed);
    }
    for (std::size_t i = 0; i < chain.points.size(); ++i) {
      if (is_too_near(chain, i)) space_from(chain.points, i, 1, chain.closed);
    }
  }
}

}  // namespace knotreel::features
