// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "cli/parse.h"
#include "knotreel/base/turn.h"

namespace knotreel::cli {

/// The size that `--scale` or, unless it is empty, `--size` asks for, at least 1 pixel.
/// @param width, height of what is drawn, in pixels.
/// @param turn  that players show it with: --size is of the picture as shown, the result of that as drawn.
/// @throws Error{kInvalidArgument} for more than a million pixels on a side.
Size output_size(double scale, const std::string& size, int width, int height, const Turn& turn = {});

/// The same without knowing what is drawn: whether --scale and --size can be at all.
void check_output_size(double scale, const std::string& size);

/// What --crop asks for, in the picture as shown; the result is a part of that as drawn.
/// @throws Error{kInvalidArgument} unless it is inside the whole picture.
/// @param whole as drawn.
Rect parse_crop(const std::string& text, Size whole, const Turn& turn = {});

}  // namespace knotreel::cli
