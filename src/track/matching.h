// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/spline/space.h"

namespace knotreel::track {

inline constexpr std::uint32_t kNoMatch = 0xffffffffU;

/// For each function of a space the one of another space over the same knots, by ids; functions along
/// features that differ only in the side are told apart by their order, if both spaces have as many of them.
/// @return by function of `to`: the function of `from`, or kNoMatch.
std::vector<std::uint32_t> match_functions(const spline::SplineSpace& from, const spline::SplineSpace& to);

}  // namespace knotreel::track
