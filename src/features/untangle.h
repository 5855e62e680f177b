// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/features/chains.h"

namespace knotreel::features {

/// Positions of the points of all chains, one entry per chain and point.
using Positions = std::vector<std::vector<Vec2>>;

Positions positions_of(const FeatureChains& chains);
Positions pixel_centres_of(const FeatureChains& chains);

/// Where curves cross, touch or fold back on themselves, takes points back to `before`, and to the pixel
/// centres, which cross nowhere, if that is not enough.
void untangle(FeatureChains& chains, const Positions& before);

/// Steps (chain, point before it) that cross, touch or overlap other ones than at a common point.
struct StepIndex {
  std::uint32_t chain = 0;
  std::uint32_t point = 0;
};
std::vector<StepIndex> crossing_steps(const FeatureChains& chains);

}  // namespace knotreel::features
