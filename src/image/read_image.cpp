// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/read_image.h"

#include <cmath>
#include <new>
#include <string>

#include "codec.h"
#include "colour_profile.h"
#include "knotreel/base/error.h"
#include "knotreel/base/input_file.h"

namespace knotreel::image {
namespace {

constexpr std::uint64_t kMaxFileBytes = std::uint64_t{1} << 30;

Decoded decode(std::span<const std::byte> file) {
  if (file.empty()) throw DecodeError("the file is empty");
  const std::optional<ImageFormat> format = detect_format(file);
  if (!format)
    throw DecodeError("not a picture in a known format (PNG, JPEG, TIFF, WebP, BMP, PNM, PAM, PFM)");
  switch (*format) {
    case ImageFormat::kPng:
      return decode_png(file);
    case ImageFormat::kPnm:
    case ImageFormat::kPam:
    case ImageFormat::kPfm:
      return decode_pnm(file);
    case ImageFormat::kTiff:
      return decode_tiff(file);
    default:
      return decode_with_opencv(file, *format);
  }
}

void check_finite(const Image& image) {
  for (const float sample : image.samples) {
    if (!std::isfinite(sample)) throw DecodeError("it holds samples that are not finite");
  }
}

}  // namespace

void check_size(std::uint64_t width, std::uint64_t height) {
  if (width == 0 || height == 0) throw DecodeError("it has no pixels");
  if (width > kMaxPixels || height > kMaxPixels || width * height > kMaxPixels) {
    throw DecodeError(std::to_string(width) + "x" + std::to_string(height) + " is more than " +
                      std::to_string(kMaxPixels) + " pixels");
  }
}

Image read_image(const std::filesystem::path& path, ImageFileInfo* info) {
  return read_image(read_whole(path, kMaxFileBytes, "image"), path, info);
}

Image read_image(std::span<const std::byte> file, const std::filesystem::path& path, ImageFileInfo* info) {
  const auto error = [&](const std::string& why) {
    return Error(ErrorKind::kInput, cannot_read(path, "image") + why);
  };
  try {
    Decoded decoded = decode(file);
    if (decoded.samples == SampleType::f32) check_finite(decoded.image);
    if (info != nullptr) {
      const ImageFormat format = *detect_format(file);
      *info = {format, decoded.samples, file.size(), has_colour_profile(file, format), decoded.more_pages};
    }
    return std::move(decoded.image);
  } catch (const DecodeError& e) {
    throw error(e.what());
  } catch (const std::bad_alloc&) {
    throw error("not enough memory");
  }
}

}  // namespace knotreel::image
