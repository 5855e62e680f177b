// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "knotreel/image/format.h"

namespace knotreel::image {

/// Whether a file of one of our formats embeds an ICC colour profile. Never throws; damaged files have none.
bool has_colour_profile(std::span<const std::byte> file, ImageFormat format) noexcept;

}  // namespace knotreel::image
