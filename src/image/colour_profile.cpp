// SPDX-License-Identifier: GPL-3.0-or-later
#include "colour_profile.h"

#include <string_view>

#include "bytes.h"
#include "tiff_file.h"

namespace knotreel::image {
namespace {

bool text_at(const Bytes& bytes, std::size_t at, std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (bytes.u8(at + i) != static_cast<unsigned char>(text[i])) return false;
  }
  return true;
}

/// An iCCP chunk comes before the image data.
bool png_profile(const Bytes& bytes) {
  for (std::size_t at = 8; !text_at(bytes, at + 4, "IDAT"); at += 12 + bytes.be32(at)) {
    if (text_at(bytes, at + 4, "iCCP")) return true;
  }
  return false;
}

/// APP2 segments with the name of ICC.1 annex B, before the first scan.
bool jpeg_profile(const Bytes& bytes) {
  for (std::size_t at = 2;;) {
    if (bytes.u8(at) != 0xff) return false;
    while (bytes.u8(at + 1) == 0xff) ++at;  // fill bytes
    const std::uint32_t marker = bytes.u8(at + 1);
    at += 2;
    if (marker == 0x01 || (marker >= 0xd0 && marker <= 0xd7)) continue;
    if (marker == 0xda || marker == 0xd9) return false;
    if (marker == 0xe2 && text_at(bytes, at + 2, "ICC_PROFILE")) return true;
    at += bytes.be16(at);
  }
}

bool tiff_profile(std::span<const std::byte> bytes) {
  const TiffFile file(bytes);
  std::uint32_t size = 0;
  const void* profile = nullptr;
  return TIFFGetField(file.handle(), TIFFTAG_ICCPROFILE, &size, &profile) != 0;
}

/// A flag of the VP8X chunk.
bool webp_profile(const Bytes& bytes) {
  return text_at(bytes, 12, "VP8X") && (bytes.u8(20) & 0x20) != 0;
}

}  // namespace

bool has_colour_profile(std::span<const std::byte> file, ImageFormat format) noexcept {
  const Bytes bytes(file);
  try {
    switch (format) {
      case ImageFormat::kPng:
        return png_profile(bytes);
      case ImageFormat::kJpeg:
        return jpeg_profile(bytes);
      case ImageFormat::kTiff:
        return tiff_profile(file);
      case ImageFormat::kWebp:
        return webp_profile(bytes);
      default:
        return false;
    }
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace knotreel::image
