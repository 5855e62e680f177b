// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/spline/basis.h"

namespace knotreel::spline {

/// A number per basis function that tells its shape and place: equal for functions of two spaces that are
/// equal everywhere, bit for bit up to the order in which their pieces are summed, and different for others
/// but for one pair in 2^64. Parallel over pieces; the same for any number of threads.
std::vector<std::uint64_t> function_fingerprints(const Basis& basis);

}  // namespace knotreel::spline
