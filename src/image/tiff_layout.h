// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "tiff_file.h"

namespace knotreel::image {

/// What the samples of a TIFF stand for.
enum class TiffColours { kGrey, kWhiteIsZero, kRgb, kPalette, kCmyk, kLab, kIccLab, kXyz, kYcbcr };

/// How the first page of a TIFF stores its samples.
struct TiffLayout {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  TiffColours colours = TiffColours::kGrey;
  int bits = 0;  ///< per sample
  bool floats = false;
  int samples = 0;         ///< per pixel: colours, then others
  int colour_samples = 0;  ///< how many of them are colours
  int alpha = 0;           ///< which of them is alpha; 0 if none is
  bool premultiplied = false;
  bool planar = false;  ///< each sample has strips or tiles of its own
  int orientation = 1;  ///< as in EXIF: 1 to 8
};

/// Reads it, and has libtiff unpack logarithmic colours to floats.
/// @throws DecodeError for sizes that are too large, and kinds that are not read.
TiffLayout tiff_layout(const TiffFile& file);

}  // namespace knotreel::image
