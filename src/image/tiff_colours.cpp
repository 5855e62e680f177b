// SPDX-License-Identifier: GPL-3.0-or-later
#include "tiff_colours.h"

#include <algorithm>
#include <cmath>

namespace knotreel::image {
namespace {

bool is_of_one_channel(TiffColours colours) {
  return colours == TiffColours::kGrey || colours == TiffColours::kWhiteIsZero;
}

using Triple = std::array<double, 3>;

/// From CIE XYZ to the primaries of sRGB with their white, D65.
Triple linear_rgb(const Triple& xyz) {
  return {3.240479 * xyz[0] - 1.537150 * xyz[1] - 0.498535 * xyz[2],
          -0.969256 * xyz[0] + 1.875991 * xyz[1] + 0.041556 * xyz[2],
          0.055648 * xyz[0] - 0.204043 * xyz[1] + 1.057311 * xyz[2]};
}

/// IEC 61966-2-1; light outside 0..1 is cut off.
double srgb_encoded(double light) {
  const double l = std::clamp(light, 0.0, 1.0);
  return l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055;
}

/// ISO/CIE 11664-4, relative to the white of sRGB: white stays white whatever light it was under.
Triple xyz_of_lab(const Triple& lab) {
  constexpr Triple kWhite{0.950456, 1, 1.088754};
  const double y = (lab[0] + 16) / 116;
  const Triple roots{y + lab[1] / 500, y, y - lab[2] / 200};
  Triple xyz;
  for (std::size_t i = 0; i < 3; ++i) {
    const double r = roots[i];
    xyz[i] = kWhite[i] * (r > 6.0 / 29 ? r * r * r : (r - 4.0 / 29) * 108 / 841);
  }
  return xyz;
}

}  // namespace

TiffConverter::TiffConverter(const TiffFile& file, const TiffLayout& layout)
    : layout_(layout),
      colour_channels_(is_of_one_channel(layout.colours) ? 1 : 3),
      has_alpha_(layout.alpha > 0),
      largest_(layout.floats ? 1 : std::exp2(layout.bits) - 1) {
  if (layout.colours == TiffColours::kPalette) find_palette(file);
}

SampleType TiffConverter::samples() const {
  if (layout_.floats || layout_.bits > 16) return SampleType::f32;
  return layout_.bits <= 8 || layout_.colours == TiffColours::kPalette ? SampleType::u8 : SampleType::u16;
}

void TiffConverter::find_palette(const TiffFile& file) {
  if (TIFFGetField(file.handle(), TIFFTAG_COLORMAP, &palette_[0], &palette_[1], &palette_[2]) == 0)
    file.fail();
  // Their upper bytes count: some programs leave the lower ones 0, and some old ones write 8 bits where 16
  // belong.
  const std::size_t size = std::size_t{1} << layout_.bits;
  const bool small = std::all_of(palette_.begin(), palette_.end(), [&](const std::uint16_t* column) {
    return std::all_of(column, column + size, [](std::uint16_t value) { return value < 256; });
  });
  palette_shift_ = small ? 0 : 8;
}

void TiffConverter::convert(const double* stored, float* to) const {
  convert_colours(stored, to);
  if (!has_alpha_) return;
  to[colour_channels_] = level(stored[layout_.colour_samples]);
  if (layout_.premultiplied) divide_by_alpha(to);
}

void TiffConverter::convert_colours(const double* stored, float* to) const {
  switch (layout_.colours) {
    case TiffColours::kWhiteIsZero:
      to[0] = level(largest_ - stored[0]);
      break;
    case TiffColours::kPalette:
      for (std::size_t c = 0; c < 3; ++c)
        to[c] = static_cast<float>(palette_[c][static_cast<std::size_t>(stored[0])] >> palette_shift_);
      break;
    case TiffColours::kCmyk:
      for (int c = 0; c < 3; ++c) to[c] = level((largest_ - stored[c]) * (largest_ - stored[3]) / largest_);
      break;
    case TiffColours::kLab:
    case TiffColours::kIccLab:
      convert_lab(stored, to);
      break;
    case TiffColours::kXyz: {
      const Triple rgb = linear_rgb({stored[0], stored[1], stored[2]});
      for (std::size_t c = 0; c < 3; ++c) to[c] = level(rgb[c]);
      break;
    }
    default:
      for (int c = 0; c < colour_channels_; ++c) to[c] = level(stored[c]);
      break;
  }
}

void TiffConverter::divide_by_alpha(float* to) const {
  const float alpha = to[colour_channels_];
  if (alpha <= 0) return;
  for (int c = 0; c < colour_channels_; ++c) {
    to[c] = to[c] * 255 / alpha;
    if (!layout_.floats) to[c] = std::min(to[c], 255.0F);  // more colour than alpha is a slip of rounding
  }
}

void TiffConverter::convert_lab(const double* stored, float* to) const {
  // a and b have a sign: in two's complement, or in ICC's encoding with the zero in the middle.
  const double zero = std::exp2(layout_.bits - 1);
  const auto signed_axis = [&](double number) {
    if (layout_.colours == TiffColours::kIccLab) return (number - zero) * 128 / zero;
    return (number < zero ? number : number - 2 * zero) * 128 / zero;
  };
  const Triple rgb =
      linear_rgb(xyz_of_lab({stored[0] * 100 / largest_, signed_axis(stored[1]), signed_axis(stored[2])}));
  for (std::size_t c = 0; c < 3; ++c) to[c] = static_cast<float>(255 * srgb_encoded(rgb[c]));
}

}  // namespace knotreel::image
