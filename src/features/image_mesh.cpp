// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/image_mesh.h"

#include <algorithm>

namespace knotreel::features {

ImageMesh make_image_mesh(const FeatureChains& chains) {
  ImageMesh mesh{chains.width, chains.height, {}};
  const int columns = std::max(0, chains.width - 1);
  const int rows = std::max(0, chains.height - 1);
  mesh.diagonals.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
  const auto step = [&](const ChainPoint& a, const ChainPoint& b) {
    if (a.x == b.x || a.y == b.y) return;
    const bool rising = (b.x > a.x) != (b.y > a.y);
    const auto square = static_cast<std::size_t>(std::min(a.y, b.y)) * static_cast<std::size_t>(columns) +
                        static_cast<std::size_t>(std::min(a.x, b.x));
    mesh.diagonals[square] = rising ? 1 : 0;
  };
  for (const Chain& chain : chains.chains) {
    for (std::size_t i = 1; i < chain.points.size(); ++i) step(chain.points[i - 1], chain.points[i]);
    if (chain.closed && !chain.points.empty()) step(chain.points.back(), chain.points.front());
  }
  return mesh;
}

}  // namespace knotreel::features
