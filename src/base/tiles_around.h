// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace knotreel {

/// By tile: 1 for those that are flagged, and for all that are up to a distance away, diagonally too; else 0.
/// @param flags row by row. @param columns of tiles, 1 or more, unless there are none. @param distance tiles.
std::vector<std::uint8_t> tiles_around(std::span<const std::uint8_t> flags, std::size_t columns,
                                       std::size_t distance);

}  // namespace knotreel
