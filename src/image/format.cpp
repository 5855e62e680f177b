// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/format.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>
#include <utility>

namespace knotreel::image {
using namespace std::string_view_literals;

std::optional<ImageFormat> detect_format(std::span<const std::byte> start) {
  const std::string_view text(reinterpret_cast<const char*>(start.data()), start.size());
  if (text.starts_with("\x89PNG\r\n\x1a\n"sv)) return ImageFormat::kPng;
  if (text.starts_with("\xff\xd8\xff"sv)) return ImageFormat::kJpeg;
  if (text.starts_with("II*\0"sv) || text.starts_with("MM\0*"sv)) return ImageFormat::kTiff;
  if (text.starts_with("II+\0"sv) || text.starts_with("MM\0+"sv)) return ImageFormat::kTiff;  // BigTIFF
  if (text.starts_with("RIFF"sv) && text.size() >= 12 && text.substr(8, 4) == "WEBP"sv)
    return ImageFormat::kWebp;
  if (text.starts_with("BM"sv)) return ImageFormat::kBmp;
  if (text.size() >= 3 && text[0] == 'P' && std::isspace(static_cast<unsigned char>(text[2])) != 0) {
    if (text[1] >= '1' && text[1] <= '6') return ImageFormat::kPnm;
    if (text[1] == '7') return ImageFormat::kPam;
    if (text[1] == 'f' || text[1] == 'F') return ImageFormat::kPfm;
  }
  return std::nullopt;
}

namespace {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

}  // namespace

std::optional<ImageFormat> format_of_extension(const std::string& extension) {
  static constexpr std::array<std::pair<std::string_view, ImageFormat>, 13> kExtensions{{
      {"png", ImageFormat::kPng},
      {"jpg", ImageFormat::kJpeg},
      {"jpeg", ImageFormat::kJpeg},
      {"tif", ImageFormat::kTiff},
      {"tiff", ImageFormat::kTiff},
      {"webp", ImageFormat::kWebp},
      {"bmp", ImageFormat::kBmp},
      {"pbm", ImageFormat::kPnm},
      {"pgm", ImageFormat::kPnm},
      {"ppm", ImageFormat::kPnm},
      {"pnm", ImageFormat::kPnm},
      {"pam", ImageFormat::kPam},
      {"pfm", ImageFormat::kPfm},
  }};
  const std::string lower = lower_case(extension);
  for (const auto& [name, format] : kExtensions) {
    if (name == lower) return format;
  }
  return std::nullopt;
}

int channels_of_extension(const std::string& extension) {
  const std::string lower = lower_case(extension);
  return lower == "pgm" ? 1 : lower == "ppm" ? 3 : 0;
}

SampleType default_samples(ImageFormat format) {
  return format == ImageFormat::kPfm ? SampleType::f32 : SampleType::u8;
}

const char* format_name(ImageFormat format) {
  switch (format) {
    case ImageFormat::kPng:
      return "PNG";
    case ImageFormat::kJpeg:
      return "JPEG";
    case ImageFormat::kTiff:
      return "TIFF";
    case ImageFormat::kWebp:
      return "WebP";
    case ImageFormat::kBmp:
      return "BMP";
    case ImageFormat::kPnm:
      return "PNM";
    case ImageFormat::kPam:
      return "PAM";
    case ImageFormat::kPfm:
      return "PFM";
  }
  return "unknown";
}

}  // namespace knotreel::image
