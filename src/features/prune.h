// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "features/gradient.h"
#include "features/link_map.h"

namespace knotreel::features {

/// A chain as drawn: from node to node, or closed (then the first pixel is not repeated).
struct Stretch {
  std::vector<int> pixels;
  bool closed = false;
};

/// The chain from i, a node with a link in that direction, or any pixel of a closed chain.
Stretch stretch_from(const LinkMap& map, int i, int direction);

/// What a chain has to be worth. Links between junctions may have any length, and half the weight: without
/// them the chains that they join would lose their common corner, and areas that are closed in the picture
/// would leak. Without any least weight textures fill with them.
struct Worth {
  const GradientField& field;
  double least_points;
  double least_weight;  ///< sum of the gradient's magnitude over its pixels

  bool enough(const LinkMap& map, const Stretch& stretch) const;
};

/// Removes the chain through a pixel that is no node, if it is not worth enough. @return whether it was
/// removed
bool drop_if_worthless(LinkMap& map, int i, const Worth& worth);

/// The same for all chains with a free end, until there is none left to drop. A junction that loses an arm
/// makes its other two one chain.
void drop_spurs(LinkMap& map, const Worth& worth);

/// The same, and makes sure that what is left is sound.
void prune(LinkMap& map, const Worth& worth);

}  // namespace knotreel::features
