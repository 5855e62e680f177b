// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/write_image.h"

#include <algorithm>
#include <limits>
#include <string>

#include "base/multiversion.h"
#include "codec.h"

namespace knotreel::image {
namespace {

constexpr int kMaxJpegSide = 65500;
constexpr int kMaxWebpSide = 16383;

/// What each format can hold (the table in ImageFileSpec).
struct Abilities {
  bool u8, u16, f32;
  bool grey, grey_alpha, rgb, rgb_alpha;
  bool whole_in_memory;
};

Abilities abilities(ImageFormat format) {
  switch (format) {
    case ImageFormat::kPng:
    case ImageFormat::kPam:
      return {true, true, false, true, true, true, true, false};
    case ImageFormat::kPnm:
      return {true, true, false, true, false, true, false, false};
    case ImageFormat::kPfm:
      return {false, false, true, true, false, true, false, false};
    case ImageFormat::kTiff:
      return {true, true, true, true, true, true, true, true};
    case ImageFormat::kJpeg:
    case ImageFormat::kBmp:  // with a fourth byte that nearly all readers ignore
      return {true, false, false, true, false, true, false, true};
    default:
      return {true, false, false, true, false, true, true, true};
  }
}

ImageFormat choose_format(const std::filesystem::path& path, const ImageFileSpec& spec) {
  if (spec.format) return *spec.format;
  if (path == "-") return ImageFormat::kPng;
  const std::string extension = path.extension().string();
  if (!extension.empty()) {
    if (const auto format = format_of_extension(extension.substr(1))) return *format;
  }
  throw Error(ErrorKind::kInvalidArgument,
              "the name '" + path.string() +
                  "' does not end in a known picture format (png, ppm, pgm, pam, "
                  "pfm, tiff, jpg, webp, bmp)");
}

/// What is left open, by the path.
ImageFileSpec complete(const std::filesystem::path& path, ImageFileSpec spec) {
  const std::string extension = path.extension().string();
  if (!spec.format && !extension.empty()) spec.file_channels = channels_of_extension(extension.substr(1));
  spec.format = choose_format(path, spec);
  return spec;
}

[[noreturn]] void refuse(const std::string& why) {
  throw Error(ErrorKind::kInvalidArgument, why);
}

void check_sides(const ImageFileSpec& spec) {
  const int most = spec.format == ImageFormat::kJpeg   ? kMaxJpegSide
                   : spec.format == ImageFormat::kWebp ? kMaxWebpSide
                                                       : std::numeric_limits<int>::max();
  if (std::max(spec.width, spec.height) <= most) return;
  refuse(std::string("a ") + format_name(*spec.format) + " file has at most " + std::to_string(most) +
         " pixels on a side; use png");
}

void check_spec(const ImageFileSpec& spec) {
  const std::string name = format_name(*spec.format);
  if (spec.width < 1 || spec.height < 1) refuse("a picture needs at least one pixel");
  const Abilities can = abilities(*spec.format);
  const bool depth = spec.samples == SampleType::u8    ? can.u8
                     : spec.samples == SampleType::u16 ? can.u16
                                                       : can.f32;
  if (!depth) {
    const char* wanted = spec.samples == SampleType::u8    ? "8-bit"
                         : spec.samples == SampleType::u16 ? "16-bit"
                                                           : "float";
    refuse(name + " does not hold " + wanted +
           " samples (8-bit: all but pfm; 16-bit: png, ppm, pam, tiff; float: "
           "pfm, tiff)");
  }
  const bool channels[] = {can.grey, can.grey_alpha, can.rgb, can.rgb_alpha};
  if (spec.channels < 1 || spec.channels > 4) refuse("a picture has 1 to 4 channels");
  if (!channels[spec.channels - 1]) {
    refuse(name + (spec.channels == 2 ? " does not hold grey with alpha; use png, pam or tiff"
                                      : " does not hold alpha; use png, pam, tiff or webp, or a background"));
  }
  if (spec.file_channels == 1 && spec.channels == 3) {
    refuse("a pgm file is grey, and the picture has colours; use ppm or pnm");
  }
  check_sides(spec);
  if (can.whole_in_memory && std::uint64_t(spec.width) * std::uint64_t(spec.height) > kMaxPixels) {
    refuse("a " + name + " file of more than " + std::to_string(kMaxPixels) +
           " pixels is not supported; use png");
  }
}

/// A whole number; 0 for what is not a number.
[[gnu::always_inline]] inline std::int32_t stored(float sample, float scale, float largest) {
  const float value = sample * scale + 0.5F;
  const float low = value > 0 ? value : 0;
  return static_cast<std::int32_t>(low < largest ? low : largest);
}

KNOTREEL_MULTIVERSION
void store_u8(const float* samples, std::size_t count, std::byte* bytes) {
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::byte>(stored(samples[i], 1, 255));
}

/// The high byte first.
KNOTREEL_MULTIVERSION
void store_u16(const float* samples, std::size_t count, std::byte* bytes) {
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t value = stored(samples[i], 257, 65535);
    bytes[2 * i] = static_cast<std::byte>(value >> 8);
    bytes[2 * i + 1] = static_cast<std::byte>(value & 0xff);
  }
}

}  // namespace

std::uint8_t to_u8(float sample) {
  return static_cast<std::uint8_t>(stored(sample, 1, 255));
}
std::uint16_t to_u16(float sample) {
  return static_cast<std::uint16_t>(stored(sample, 257, 65535));
}

void append_samples(std::span<const float> samples, SampleType type, std::vector<std::byte>& bytes) {
  const std::size_t end = bytes.size();
  if (type == SampleType::u8) {
    bytes.resize(end + samples.size());
    store_u8(samples.data(), samples.size(), bytes.data() + end);
  } else {
    bytes.resize(end + 2 * samples.size());
    store_u16(samples.data(), samples.size(), bytes.data() + end);
  }
}

void CheckedRowWriter::write(std::span<const float> rows, int count) {
  const std::size_t row_size = std::size_t(spec_.width) * std::size_t(spec_.channels);
  if (count < 0 || count > spec_.height - rows_written_ || rows.size() != std::size_t(count) * row_size) {
    throw Error(ErrorKind::kInvalidArgument, "rows of another shape than the picture");
  }
  for (int i = 0; i < count; ++i) {
    write_row(rows.subspan(std::size_t(i) * row_size, row_size));
    ++rows_written_;
  }
}

void CheckedRowWriter::finish() {
  if (rows_written_ != spec_.height) {
    throw Error(ErrorKind::kInvalidArgument, "a picture was finished before all of its rows were written");
  }
  complete();
  file_->commit();
}

void check_image_spec(const std::filesystem::path& path, const ImageFileSpec& spec) {
  check_spec(complete(path, spec));
}

std::unique_ptr<RowWriter> open_image_writer(const std::filesystem::path& path, const ImageFileSpec& wanted) {
  const ImageFileSpec spec = complete(path, wanted);
  check_spec(spec);
  auto file = std::make_unique<OutputFile>(path);
  switch (*spec.format) {
    case ImageFormat::kPng:
      return make_png_writer(std::move(file), spec);
    case ImageFormat::kPnm:
    case ImageFormat::kPam:
      return make_pnm_writer(std::move(file), spec);
    case ImageFormat::kPfm:
      if (!file->seekable()) {
        throw Error(ErrorKind::kOutput, "cannot write " + file->name() +
                                            ": PFM is stored bottom row first and needs a real file");
      }
      return make_pnm_writer(std::move(file), spec);
    case ImageFormat::kTiff:
      return make_tiff_writer(std::move(file), spec);
    default:
      return make_opencv_writer(std::move(file), spec);
  }
}

void write_image(const std::filesystem::path& path, const Image& image, SampleType samples) {
  const auto writer =
      open_image_writer(path, {image.width, image.height, image.channels, samples, std::nullopt, 0});
  writer->write(image.samples, image.height);
  writer->finish();
}

}  // namespace knotreel::image
