// SPDX-License-Identifier: GPL-3.0-or-later
#include <png.h>

#include <algorithm>
#include <bit>
#include <csetjmp>
#include <cstring>

#include "codec.h"

namespace knotreel::image {
namespace {

/// State that libpng's callbacks see. libpng reports errors by longjmp, so everything with a destructor lives
/// here, outside the functions that are jumped over.
struct Source {
  std::span<const std::byte> file;
  std::size_t position = 0;
  std::string error;
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::vector<std::byte> raw;
  std::vector<png_bytep> rows;
  png_uint_32 width = 0, height = 0;
  int bit_depth = 0;
  int channels = 0;

  ~Source() { png_destroy_read_struct(&png, &info, nullptr); }
};

[[noreturn]] void on_error(png_structp png, png_const_charp message) {
  static_cast<Source*>(png_get_error_ptr(png))->error = message;
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void read_bytes(png_structp png, png_bytep to, std::size_t count) {
  auto* source = static_cast<Source*>(png_get_io_ptr(png));
  if (source->file.size() - source->position < count) png_error(png, "the file is cut short");
  std::memcpy(to, source->file.data() + source->position, count);
  source->position += count;
}

// setjmp must be called in the frame that stays alive; a lambda without owning locals may be jumped over.
template <typename Body>
void guarded(Source& source, Body body) {
  if (setjmp(png_jmpbuf(source.png)) != 0) throw DecodeError(source.error);
  body();
}

}  // namespace

Decoded decode_png(std::span<const std::byte> file) {
  Source source{.file = file, .error = {}, .raw = {}, .rows = {}};
  source.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, on_error, on_warning);
  if (source.png != nullptr) source.info = png_create_info_struct(source.png);
  if (source.info == nullptr) throw std::bad_alloc();

  guarded(source, [&] {
    png_set_read_fn(source.png, &source, read_bytes);
    png_set_user_limits(source.png, 0x7fffffff, 0x7fffffff);  // check_size() decides
    png_read_info(source.png, source.info);
    source.width = png_get_image_width(source.png, source.info);
    source.height = png_get_image_height(source.png, source.info);
  });
  check_size(source.width, source.height);
  // Deflate shrinks at most 1032 : 1, so a header that promises more is known to lie before memory is taken.
  // Stored rows: palettes and single bits become several times as much.
  const std::size_t stored_bytes = png_get_rowbytes(source.png, source.info) * source.height;
  if (stored_bytes / 1032 > file.size()) throw DecodeError("the file is cut short");

  guarded(source, [&] {
    png_set_expand(source.png);  // palette to RGB, transparent colour to alpha, fewer than 8 bits to 8
    if constexpr (std::endian::native == std::endian::little) png_set_swap(source.png);
    png_set_interlace_handling(source.png);
    png_read_update_info(source.png, source.info);
    source.bit_depth = png_get_bit_depth(source.png, source.info);
    source.channels = png_get_channels(source.png, source.info);
  });
  const std::size_t row_bytes = png_get_rowbytes(source.png, source.info);
  source.raw.resize(row_bytes * source.height);
  source.rows.resize(source.height);
  for (std::size_t y = 0; y < source.height; ++y) {
    source.rows[y] = reinterpret_cast<png_bytep>(source.raw.data() + y * row_bytes);
  }
  guarded(source, [&] {
    png_read_image(source.png, source.rows.data());
    png_read_end(source.png, nullptr);
  });

  Decoded decoded;
  decoded.image =
      make_image(static_cast<int>(source.width), static_cast<int>(source.height), source.channels);
  decoded.samples = source.bit_depth == 16 ? SampleType::u16 : SampleType::u8;
  std::vector<float>& samples = decoded.image.samples;
  if (source.bit_depth == 16) {
    for (std::size_t i = 0; i < samples.size(); ++i) {
      std::uint16_t value;
      std::memcpy(&value, source.raw.data() + 2 * i, 2);
      samples[i] = static_cast<float>(value) / 257.0F;
    }
  } else {
    std::transform(source.raw.begin(), source.raw.end(), samples.begin(),
                   [](std::byte b) { return static_cast<float>(b); });
  }
  return decoded;
}

}  // namespace knotreel::image
