// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/base/pixel_box.h"

namespace knotreel::motion {

/// A few boxes without a common pixel that hold all cells that change, with a margin around each.
/// @param unchanged of unchanged_cells() for a picture of this size. @param margin pixels, 0 or more.
std::vector<PixelBox> changed_boxes(std::span<const std::uint8_t> unchanged, int width, int height,
                                    int margin);

}  // namespace knotreel::motion
