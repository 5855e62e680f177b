// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "knotreel/base/vec2.h"

/// Feature curves of a picture (paper sec. 5.1, 5.2).
namespace knotreel::features {

using NodeIndex = std::uint32_t;

/// One point of a feature curve: the pixel that the detector drew, and the place of the curve there.
struct ChainPoint {
  std::int32_t x = 0;  ///< pixel column
  std::int32_t y = 0;  ///< pixel row
  Vec2 position;  ///< on the curve, in image coordinates; within one pixel of (x + 0.5, y + 0.5) per axis
  Vec2 beyond{};  ///< on from there to the curve, where that is further away: at sharp corners
  bool corner = false;  ///< the curve has a sharp corner here, or several meet (sharpen_corners())

  bool rounded = false;  ///< the curve is an arc here, between straight stretches (prefer_side_ends())

  /// A vertex of a polyline had better be here: that of the frame before had one (prefer_points()), or a
  /// straight stretch ends (prefer_side_ends()).
  bool preferred = false;

  Vec2 on_curve() const { return position + beyond; }
  /// Puts the curve there, and the position as near to it as it may be.
  void move_to(Vec2 p) {
    position = {std::clamp(p.x, x - 0.5, x + 1.5), std::clamp(p.y, y - 0.5, y + 1.5)};
    beyond = p - position;
  }
};

/// A one-pixel wide curve: consecutive pixels are 8-neighbours. An open chain runs from node to node; its end
/// points are shared, pixel and position, with all other chains that have the same node. In a closed chain
/// the last point is followed by the first, there is no node, and it has at least eight points.
struct Chain {
  std::vector<ChainPoint> points;  ///< at least two
  bool closed = false;
  NodeIndex first_node = 0;
  NodeIndex last_node = 0;
  bool first_on_border = false;  ///< the curve runs on to the side of the picture next to its end pixel
  bool last_on_border = false;
  bool stepped = false;  ///< no colours in between, as without antialiasing: known to half a pixel
};

/// All feature curves of a picture. No pixel belongs to two chains, nor twice to one, except for nodes.
/// Pixels of chains that are 8-neighbours are consecutive or within two steps of a common node, so that every
/// edge of the image mesh between two feature pixels lies along a curve; no two diagonal steps cross.
struct FeatureChains {
  int width = 0;
  int height = 0;
  std::vector<Chain> chains;
  NodeIndex node_count = 0;  ///< nodes are numbered from 0
};

}  // namespace knotreel::features
