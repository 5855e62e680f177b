// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/prefer_points.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace knotreel::features {
void prefer_points(FeatureChains& chains, std::span<const Vec2> places, double distance) {
  const int around = static_cast<int>(distance) + 1;  // points are within a pixel of theirs
  std::vector<ChainPoint*> at(static_cast<std::size_t>(chains.width) *
                              static_cast<std::size_t>(chains.height));
  for (Chain& chain : chains.chains) {
    for (ChainPoint& p : chain.points) {
      p.preferred = false;
      at[static_cast<std::size_t>(p.y) * static_cast<std::size_t>(chains.width) +
         static_cast<std::size_t>(p.x)] = &p;
    }
  }
  for (const Vec2 place : places) {
    if (!(place.x >= 0 && place.y >= 0 && place.x <= chains.width && place.y <= chains.height)) continue;
    const int column = static_cast<int>(place.x);
    const int row = static_cast<int>(place.y);
    ChainPoint* nearest = nullptr;
    double least = distance;
    for (int y = std::max(0, row - around); y <= std::min(chains.height - 1, row + around); ++y) {
      for (int x = std::max(0, column - around); x <= std::min(chains.width - 1, column + around); ++x) {
        ChainPoint* const p = at[static_cast<std::size_t>(y) * static_cast<std::size_t>(chains.width) +
                                 static_cast<std::size_t>(x)];
        if (p == nullptr || norm(p->on_curve() - place) >= least) continue;
        nearest = p;
        least = norm(p->on_curve() - place);
      }
    }
    if (nearest != nullptr) nearest->preferred = true;
  }
}

}  // namespace knotreel::features
