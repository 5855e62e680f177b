// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

namespace knotreel::knots {

inline constexpr int kBlockSide = 16;  ///< pixels

/// Of a picture in blocks of kBlockSide x kBlockSide pixels from its upper left corner, keeps the squared
/// errors of those whose root mean square is above a bound; all others become 0.
/// @param squared_errors per pixel, row-major. @param bound levels.
/// @return how many blocks are above.
std::size_t keep_worst_blocks(std::span<float> squared_errors, int width, int height, double bound);

}  // namespace knotreel::knots
