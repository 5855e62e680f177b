// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

/// Picture files that the library does not write itself.
namespace knotreel::test {

/// A PNG with a palette of 16 entries: a ramp of 32 x 24 pixels.
void write_palette_png(const std::filesystem::path& path);

/// The bytes of a JPEG with four components as Adobe stores CMYK: 8 x 8 pixels of one colour.
std::string cmyk_jpeg();

/// The start of a PNG that claims so many pixels; its checksums are right.
std::string png_header(unsigned width, unsigned height);

}  // namespace knotreel::test
