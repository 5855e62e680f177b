// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "knotreel/image/image.h"

namespace knotreel::video {

/// At most 256 colours to draw a picture with.
struct Palette {
  std::array<std::uint32_t, 256> colours{};  ///< 0xAARRGGBB; 0: none, and what is transparent
  std::size_t first = 0;                     ///< of those that there are
  std::size_t count = 0;                     ///< of these, one after the other
};

/// The colours for a picture: as long as there are more to be had, the group of pixels whose colours miss
/// their mean most, in sum, is divided at the mean of the channel that varies most (after [Heckbert82]);
/// then each colour moves to the mean of the pixels that it is nearest to (after [Lloyd82]), three times.
/// Pixels whose colours agree in the upper six bits of each channel stay together. If the entries that there
/// are suffice for all colours, all are exact. Index 0 is transparent, but for opaque pictures of 256
/// colours.
/// @param before  of the frame before, which stays if it does nearly as well; or null.
Palette choose_palette(const image::Image& picture, const Palette* before = nullptr);

}  // namespace knotreel::video
