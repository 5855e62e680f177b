// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/image/image.h"

namespace knotreel::image {

/// Which square cells of a picture are as they are in another of the same size, bit for bit.
/// @param side of a cell, pixels, 1 or more.
/// @return 1 or 0 per cell, row-major; those on the right and at the bottom may be smaller.
/// @throws Error{kInvalidArgument} if sizes or channels differ.
std::vector<std::uint8_t> same_cells(const Image& a, const Image& b, int side);

}  // namespace knotreel::image
