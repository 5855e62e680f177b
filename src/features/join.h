// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "features/link_map.h"

namespace knotreel::features {

/// Junctions and tips of one chain are at least this many steps apart. Closer ones would make chains without
/// room for a straight piece of their own.
inline constexpr int kNodeDistance = 4;

/// How far tips are joined to other chains.
enum class Join {
  kContacts,  ///< where there is a single free pixel in between, as left by walks that stop before they touch
  kGaps       ///< over up to three pixels, if the chain heads there
};

/// Joins a tip (a pixel with one link) to a chain near it and ahead of it, be it its own; false if there is
/// none. The map stays sound.
bool join_tip(LinkMap& map, int tip, Join join);

/// Makes a chain that ends near a side of the picture, and heads there, run on to it; false if it does not.
bool extend_to_side(LinkMap& map, int tip);

}  // namespace knotreel::features
