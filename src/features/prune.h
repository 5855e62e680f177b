#pragma once

#include <vector>

#include "features/link_map.h"

namespace knotreel::features {

/// A chain as drawn: from node to node, or closed (then the first pixel is not repeated).
struct Stretch {
  std::vector<int> pixels;
  bool closed = false;
};

/// The chain from i, a node with a link in that direction, or any pixel of a closed chain.
Stretch stretch_from(const LinkMap& map, int i, int direction);

/// Removes the chain through a pixel that is no node, if it is shorter than min_length and ends freely (or at
/// a side), or is closed. Short links between junctions stay: without them the two chains that they join
/// would lose their common corner, and areas that are closed in the picture would leak.
/// @return whether it was removed
bool drop_if_short(LinkMap& map, int i, double min_length);

/// drop_if_short() for all chains, until there is none left to drop. A junction that loses an arm makes its
/// other two one chain.
void prune(LinkMap& map, double min_length);

}  // namespace knotreel::features
