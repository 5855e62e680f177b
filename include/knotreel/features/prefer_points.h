// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "knotreel/base/vec2.h"
#include "knotreel/features/chains.h"

namespace knotreel::features {

/// Marks the point of the chains that is nearest to each of some places as ChainPoint::preferred; of places
/// that are as far as a distance (pixels, >= 0) from all chains, none. Others are not preferred any more.
void prefer_points(FeatureChains& chains, std::span<const Vec2> places, double distance);

}  // namespace knotreel::features
