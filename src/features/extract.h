// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "features/gradient.h"
#include "features/link_map.h"
#include "knotreel/features/chains.h"

namespace knotreel::features {

/// The chains of a drawing, in the order of their first pixels, nodes before closed chains; positions
/// refined. Pixels are those of the whole that the field may be a window of.
FeatureChains extract_chains(const LinkMap& map, const GradientField& field);

}  // namespace knotreel::features
