// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "knotreel/image/image.h"

namespace knotreel::image {

/// Opaque colour to put a picture with alpha on, 0..255; none keeps the alpha.
using Background = std::optional<std::array<float, 3>>;

/// Channels of a picture after it was put on the background: no alpha, and three if that brings colours.
int channels_on(const Background& background, int channels);

/// Puts samples with alpha (2 or 4 channels) on a colour; the result is tightly packed, with
/// channels_on() channels. Others are left as they are.
void put_on_background(std::vector<float>& samples, int channels, const Background& background);

/// The same for a whole picture.
Image on_background(Image picture, const Background& background);

}  // namespace knotreel::image
