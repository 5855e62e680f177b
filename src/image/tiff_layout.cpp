// SPDX-License-Identifier: GPL-3.0-or-later
#include "tiff_layout.h"

#include <algorithm>
#include <string>

#include "codec.h"
#include "tiff_samples.h"

namespace knotreel::image {
namespace {

[[noreturn]] void not_read(const std::string& kind) {
  throw DecodeError("it is a TIFF of " + kind + ", which is not read");
}

/// Where the tag is missing, libtiff's own reader guesses the same.
int photometric_of(const TiffFile& file, int samples) {
  std::uint16_t photometric = 0;
  if (TIFFGetField(file.handle(), TIFFTAG_PHOTOMETRIC, &photometric) != 0) return photometric;
  const auto compression = file.tag<std::uint16_t>(TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  if (compression >= COMPRESSION_CCITTRLE && compression <= COMPRESSION_CCITTFAX4)
    return PHOTOMETRIC_MINISWHITE;
  return samples >= 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK;
}

TiffColours colours_of(const TiffFile& file, int photometric) {
  switch (photometric) {
    case PHOTOMETRIC_MINISWHITE:
      return TiffColours::kWhiteIsZero;
    case PHOTOMETRIC_MINISBLACK:
    case PHOTOMETRIC_LOGL:
      return TiffColours::kGrey;
    case PHOTOMETRIC_RGB:
      return TiffColours::kRgb;
    case PHOTOMETRIC_PALETTE:
      return TiffColours::kPalette;
    case PHOTOMETRIC_SEPARATED:
      if (file.tag<std::uint16_t>(TIFFTAG_INKSET, INKSET_CMYK) != INKSET_CMYK)
        not_read("inks other than CMYK");
      return TiffColours::kCmyk;
    case PHOTOMETRIC_CIELAB:
      return TiffColours::kLab;
    case PHOTOMETRIC_ICCLAB:
      return TiffColours::kIccLab;
    case PHOTOMETRIC_LOGLUV:
      return TiffColours::kXyz;
    case PHOTOMETRIC_YCBCR:
      return TiffColours::kYcbcr;
    case PHOTOMETRIC_CFA:
    case 34892:  // linear raw, of DNG
      not_read("raw data of a camera");
    default:
      not_read("photometric interpretation " + std::to_string(photometric));
  }
}

int colour_samples_of(TiffColours colours) {
  switch (colours) {
    case TiffColours::kGrey:
    case TiffColours::kWhiteIsZero:
    case TiffColours::kPalette:
      return 1;
    case TiffColours::kCmyk:
      return 4;
    default:
      return 3;
  }
}

bool is_lab(TiffColours colours) {
  return colours == TiffColours::kLab || colours == TiffColours::kIccLab;
}

void find_alpha(const TiffFile& file, TiffLayout& layout) {
  std::uint16_t count = 0;
  const std::uint16_t* kinds = nullptr;
  TIFFGetFieldDefaulted(file.handle(), TIFFTAG_EXTRASAMPLES, &count, &kinds);
  const int others = layout.samples - layout.colour_samples;
  for (int i = 0; i < std::min<int>(count, others); ++i) {
    if (kinds[i] == EXTRASAMPLE_UNSPECIFIED) continue;
    layout.alpha = layout.colour_samples + i;
    layout.premultiplied = kinds[i] == EXTRASAMPLE_ASSOCALPHA;
    return;
  }
  // RGBA without a word on the fourth sample has alpha as it is: OpenCV writes such files, our own among
  // them.
  if (layout.colours == TiffColours::kRgb && others == 1) layout.alpha = layout.colour_samples;
}

void check_samples(const TiffLayout& layout, int format) {
  if (layout.samples < layout.colour_samples) throw DecodeError("its header is damaged");
  if (format == SAMPLEFORMAT_COMPLEXINT || format == SAMPLEFORMAT_COMPLEXIEEEFP) not_read("complex numbers");
  if (format == SAMPLEFORMAT_INT && !is_lab(layout.colours)) not_read("integers with a sign");
  const std::string kind = std::to_string(layout.bits) + "-bit " + (layout.floats ? "floats" : "integers");
  if (tiff_unpacker(layout.bits, layout.floats) == nullptr) not_read(kind);
  if (is_lab(layout.colours) && (layout.floats || (layout.bits != 8 && layout.bits != 16)))
    not_read("Lab colours of " + kind);
  if (layout.colours == TiffColours::kPalette && (layout.floats || layout.bits > 16))
    not_read("palettes and " + kind);
}

}  // namespace

TiffLayout tiff_layout(const TiffFile& file) {
  TiffLayout layout;
  layout.width = file.tag<std::uint32_t>(TIFFTAG_IMAGEWIDTH, 0);
  layout.height = file.tag<std::uint32_t>(TIFFTAG_IMAGELENGTH, 0);
  check_size(layout.width, layout.height);
  const auto compression = file.tag<std::uint16_t>(TIFFTAG_COMPRESSION, COMPRESSION_NONE);
  if (TIFFIsCODECConfigured(compression) == 0) not_read("compression " + std::to_string(compression));
  layout.samples = file.tag<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL, 1);
  const int photometric = photometric_of(file, layout.samples);
  layout.colours = colours_of(file, photometric);
  if (photometric == PHOTOMETRIC_LOGL || photometric == PHOTOMETRIC_LOGLUV)
    TIFFSetField(file.handle(), TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT);  // changes the tags that follow
  layout.bits = file.tag<std::uint16_t>(TIFFTAG_BITSPERSAMPLE, 1);
  const int format = file.tag<std::uint16_t>(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
  layout.floats = format == SAMPLEFORMAT_IEEEFP;
  layout.colour_samples = colour_samples_of(layout.colours);
  layout.planar = file.tag<std::uint16_t>(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) == PLANARCONFIG_SEPARATE;
  layout.orientation = file.tag<std::uint16_t>(TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
  if (layout.colours != TiffColours::kYcbcr) {
    check_samples(layout, format);
    find_alpha(file, layout);
  }
  return layout;
}

}  // namespace knotreel::image
