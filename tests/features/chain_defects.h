// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "knotreel/features/chains.h"

namespace knotreel::features {

/// For tests: the first promise of FeatureChains (see chains.h) that does not hold, in words; nothing if all
/// do. Linear time.
std::optional<std::string> find_defect(const FeatureChains& chains);

}  // namespace knotreel::features
