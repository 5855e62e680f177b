// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "knotreel/base/vec2.h"

namespace knotreel::fit {

inline Vec2 pixel_centre(std::size_t column, std::size_t row) {
  return {static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5};
}

/// @param pixel its number, row by row. @param width of the picture.
inline Vec2 centre_of_pixel(std::size_t pixel, int width) {
  return pixel_centre(pixel % std::size_t(width), pixel / std::size_t(width));
}

}  // namespace knotreel::fit
