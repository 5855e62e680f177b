// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>

namespace knotreel::image {

/// File formats that are read and written. kPnm is PBM, PGM and PPM.
enum class ImageFormat { kPng, kJpeg, kTiff, kWebp, kBmp, kPnm, kPam, kPfm };

/// How samples are stored; 255 of an Image is the largest value of u8 and u16, and 1.0 of f32.
enum class SampleType { u8, u16, f32 };

/// The format that the first bytes of a file (16 are enough) announce; none if it is no picture we read.
std::optional<ImageFormat> detect_format(std::span<const std::byte> start);

/// The format of a file name extension without the dot, such as "png", "JPG" or "ppm"; none if unknown.
std::optional<ImageFormat> format_of_extension(const std::string& extension);

/// Channels that files of this extension have: 1 of "pgm", 3 of "ppm", 0 of all others, which are free.
int channels_of_extension(const std::string& extension);

/// How samples are stored if nothing is said: floats in PFM, 8 bits elsewhere.
SampleType default_samples(ImageFormat format);

/// Short name, such as "PNG".
const char* format_name(ImageFormat format);

}  // namespace knotreel::image
