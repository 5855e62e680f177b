#include "knotreel/features/prefer_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace knotreel::features {
namespace {

constexpr double kNearEnough = 2;  // pixels
constexpr int kPixelsAround =
    3;  // pixels from a place to those whose points can be as near: points are within one of theirs

}  // namespace

void prefer_points(FeatureChains& chains, std::span<const Vec2> places) {
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
    double least = kNearEnough;
    for (int y = std::max(0, row - kPixelsAround); y <= std::min(chains.height - 1, row + kPixelsAround);
         ++y) {
      for (int x = std::max(0, column - kPixelsAround);
           x <= std::min(chains.width - 1, column + kPixelsAround); ++x) {
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
