// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "knotreel/image/format.h"
#include "tiff_layout.h"

namespace knotreel::image {

/// Turns the numbers that a TIFF stores for a pixel into our samples. The file must outlive it.
class TiffConverter {
 public:
  /// @throws DecodeError if a palette is missing.
  TiffConverter(const TiffFile& file, const TiffLayout& layout);

  /// Channels of the picture.
  int channels() const { return colour_channels_ + (has_alpha_ ? 1 : 0); }
  /// The depth of the picture.
  SampleType samples() const;
  /// @param stored  the colours of one pixel, then alpha if there is any. @param to  channels() samples
  void convert(const double* stored, float* to) const;

 private:
  float level(double number) const { return static_cast<float>(number * 255 / largest_); }
  void convert_colours(const double* stored, float* to) const;
  void divide_by_alpha(float* to) const;
  void find_palette(const TiffFile& file);
  void convert_lab(const double* stored, float* to) const;

  TiffLayout layout_;
  int colour_channels_;
  bool has_alpha_;
  double largest_;  ///< the number that stands for full light
  std::array<const std::uint16_t*, 3> palette_{};
  int palette_shift_ = 8;
};

}  // namespace knotreel::image
