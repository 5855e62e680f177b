// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/features/chains.h"
#include "knotreel/param/parametrization.h"

namespace knotreel::vectorize {

/// By curve sample of a map: 1 where a polyline has a vertex and its curve none, so that the two segments
/// should go on into each other there (docs/decisions/0042).
std::vector<std::uint8_t> smooth_vertices(const param::Parametrization& map,
                                          const features::FeatureChains& chains);

}  // namespace knotreel::vectorize
