// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <initializer_list>

#include "knotreel/features/chains.h"

namespace knotreel::features {

/// Brings chains of detect_features() for parts of a picture into the order that those of the whole have:
/// open ones by the pixel where they begin and the way that they go there, closed ones behind them.
void sort_as_found(FeatureChains& chains);

/// Gives nodes the numbers that they have where all of these chains are one list: by rows and columns.
/// @param lists of the same picture; those without a chain are numbered, too. Lists may have chains in
/// common.
void number_nodes(std::initializer_list<FeatureChains*> lists);

}  // namespace knotreel::features
