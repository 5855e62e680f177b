#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "knotreel/image/image.h"

namespace knotreel::video {

/// A picture in at most 256 colours.
struct PalettePicture {
  std::array<std::uint32_t, 256> colours{};  ///< 0xAARRGGBB; those not used are 0
  std::vector<std::uint8_t> indices;         ///< by pixel, row-major
};

/// Colours of its own for a picture: as long as there are more to be had, the group of pixels whose colours
/// miss their mean most, in sum, is divided at the mean of the channel that varies most (after [Heckbert82]).
/// Pixels whose colours agree in the upper six bits of each channel stay together. If 256 colours are enough,
/// all are exact. Alpha below a half becomes none (index 0), and all other opaque. No dither.
PalettePicture in_palette(const image::Image& picture);

}  // namespace knotreel::video
