#pragma once

#include <string>

#include "cli/parse.h"

namespace knotreel::cli {

/// The size that `--scale` or, unless it is empty, `--size` asks for, at least 1 pixel.
/// @param width, height of what is drawn, in pixels.
/// @throws Error{kInvalidArgument} for more than a million pixels on a side.
Size output_size(double scale, const std::string& size, int width, int height);

/// What --crop asks for. @throws Error{kInvalidArgument} unless it is inside the whole picture.
Rect parse_crop(const std::string& text, Size whole);

}  // namespace knotreel::cli
