// SPDX-License-Identifier: GPL-3.0-or-later
#include "odd_pictures.h"

#include <png.h>

#include <cstdint>
#include <stdexcept>
#include <vector>

namespace knotreel::test {
namespace {

std::string bytes(std::initializer_list<int> values) {
  return {values.begin(), values.end()};
}

std::string big_endian(std::uint32_t value) {
  std::string text;
  for (int shift = 24; shift >= 0; shift -= 8) text += static_cast<char>(value >> shift & 0xff);
  return text;
}

std::uint32_t crc32(const std::string& text) {
  std::uint32_t crc = 0xffffffff;
  for (const char c : text) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1) != 0 ? 0xedb88320 : 0);
  }
  return ~crc;
}

/// A table of one Huffman class with codes of one length.
std::string huffman(int table, int length, const std::string& symbols) {
  std::string counts(16, '\0');
  counts[static_cast<std::size_t>(length - 1)] = static_cast<char>(symbols.size());
  return bytes({0xff, 0xc4, 0, static_cast<int>(19 + symbols.size()), table}) + counts + symbols;
}

}  // namespace

void write_palette_png(const std::filesystem::path& path) {
  constexpr png_uint_32 kWidth = 32;
  constexpr png_uint_32 kHeight = 24;
  std::vector<png_byte> palette;
  for (int i = 0; i < 16; ++i) palette.insert(palette.end(), {png_byte(16 * i), png_byte(80 + 8 * i), 120});
  std::vector<png_byte> indices;
  for (png_uint_32 i = 0; i < kWidth * kHeight; ++i) indices.push_back(png_byte(i % kWidth / 2));
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = kWidth;
  image.height = kHeight;
  image.format = PNG_FORMAT_RGB_COLORMAP;
  image.colormap_entries = 16;
  if (png_image_write_to_file(&image, path.c_str(), 0, indices.data(), 0, palette.data()) == 0) {
    throw std::runtime_error(image.message);
  }
}

std::string cmyk_jpeg() {
  std::string jpeg = bytes({0xff, 0xd8});
  jpeg += bytes({0xff, 0xee, 0, 14}) + "Adobe" + bytes({0, 100, 0, 0, 0, 0, 0});  // no YCCK
  jpeg += bytes({0xff, 0xdb, 0, 67, 0}) + std::string(64, '\x08');  // a step of the mean is one level
  jpeg += bytes({0xff, 0xc0, 0, 20, 8, 0, 8, 0, 8, 4});
  for (int component = 1; component <= 4; ++component) jpeg += bytes({component, 0x11, 0});
  // Codes of the mean: 00 no change, 01 a change of 32 to 63 either way. Of the rest: 0, nothing follows.
  jpeg += huffman(0x00, 2, bytes({0, 6}));
  jpeg += huffman(0x10, 1, bytes({0}));
  jpeg += bytes({0xff, 0xda, 0, 14, 4});
  for (int component = 1; component <= 4; ++component) jpeg += bytes({component, 0});
  jpeg += bytes({0, 63, 0});
  // 01 101000 0 (128 + 40), 01 010111 0 (128 - 40), 00 0 (128), 01 111100 0 (128 + 60), then ones.
  jpeg += bytes({0x68, 0x2b, 0x83, 0xe3});
  return jpeg + bytes({0xff, 0xd9});
}

std::string png_header(unsigned width, unsigned height) {
  const std::string header = "IHDR" + big_endian(width) + big_endian(height) + bytes({8, 2, 0, 0, 0});
  return bytes({0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'}) + big_endian(13) + header +
         big_endian(crc32(header));
}

}  // namespace knotreel::test
