// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "knotreel/base/error.h"
#include "knotreel/image/format.h"
#include "knotreel/image/image.h"

namespace knotreel::image {

/// What is known of a picture file besides its pixels.
struct ImageFileInfo {
  ImageFormat format = ImageFormat::kPng;
  SampleType samples = SampleType::u8;  ///< as decoded: depths below 8 bits count as u8
  std::uint64_t file_bytes = 0;
  bool colour_profile = false;  ///< an ICC profile is embedded; it is not applied
  bool more_pages = false;      ///< a TIFF has others than the one that was read; thumbnails do not count
};

/// Reads a picture: PNG, JPEG (also CMYK), TIFF, WebP, BMP, PBM/PGM/PPM, PAM, PFM, recognised by content; the
/// first page of a TIFF. Palettes are resolved, alpha is kept, a JPEG is turned as its EXIF orientation says,
/// and a TIFF by its tag.
/// @param path  a file, or `-` for standard input.
/// @param info  filled in if not null.
/// @throws Error{kInput}: `cannot read image 'x.png': <why>`, for anything missing, unreadable, unknown,
/// damaged, cut short, not finite, over kMaxPixels (checked before decoding), over 1 GiB, or too large for
/// the memory. Safe to call from several threads. While a JPEG, WebP or BMP is decoded, the standard
/// error of the process is mute, because the codecs would print there.
Image read_image(const std::filesystem::path& path, ImageFileInfo* info = nullptr);

/// The same for one that has been read already. @param path  where from, for messages.
Image read_image(std::span<const std::byte> file, const std::filesystem::path& path,
                 ImageFileInfo* info = nullptr);

}  // namespace knotreel::image
