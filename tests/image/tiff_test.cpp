// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <tiffio.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <random>

#include "knotreel/base/error.h"
#include "knotreel/image/read_image.h"
#include "support/temp_dir.h"

namespace knotreel::image {
namespace {

using test::TempDir;

/// How a picture is stored; the numbers are what the samples stand for.
struct Kind {
  std::uint16_t photometric = PHOTOMETRIC_RGB;
  int samples = 3;
  int bits = 8;
  std::uint16_t format = SAMPLEFORMAT_UINT;
  std::vector<std::uint16_t> others = {};  ///< the samples that are no colours: EXTRASAMPLE_...
  bool planar = false;
  bool tiled = false;
  std::uint16_t compression = COMPRESSION_NONE;
  const char* mode = "w";  ///< of TIFFOpen()
  int width = 37;
  int height = 21;

  bool floats() const { return format == SAMPLEFORMAT_IEEEFP; }
  double largest() const { return floats() ? 1 : std::exp2(bits) - 1; }
};

/// The stored number of a sample of a pixel.
using Numbers = std::function<double(int x, int y, int sample)>;

std::uint64_t bits_of(double number, const Kind& kind) {
  if (!kind.floats()) return static_cast<std::uint64_t>(number);
  std::uint64_t bits = 0;
  const auto single = static_cast<float>(number);
  if (kind.bits == 64) std::memcpy(&bits, &number, 8);
  if (kind.bits == 32) std::memcpy(&bits, &single, 4);
  if (kind.bits == 16) {  // normal numbers only
    int exponent = 0;
    const double fraction = std::frexp(std::abs(number), &exponent);
    bits = number == 0 ? 0 : static_cast<std::uint64_t>((exponent + 14) * 1024 + fraction * 2048 - 1024);
    if (number < 0) bits |= 0x8000;
  }
  return bits;
}

/// Samples of one row next to each other: whole bytes as the machine has them, others highest bit first.
std::vector<unsigned char> packed(const std::vector<double>& numbers, const Kind& kind) {
  const auto bits = static_cast<std::size_t>(kind.bits);
  std::vector<unsigned char> bytes((numbers.size() * bits + 7) / 8);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::uint64_t value = bits_of(numbers[i], kind);
    if (bits % 8 == 0) {
      std::memcpy(bytes.data() + i * bits / 8, &value, bits / 8);  // of a machine with the low byte first
      continue;
    }
    for (std::size_t bit = 0; bit < bits; ++bit) {
      const std::size_t place = i * bits + bit;
      if ((value >> (bits - 1 - bit) & 1) != 0)
        bytes[place / 8] |= static_cast<unsigned char>(0x80 >> place % 8);
    }
  }
  return bytes;
}

/// Numbers of a row of pixels, of all samples or one; past the right and lower border whatever is there.
std::vector<double> numbers_at(const Kind& kind, const Numbers& numbers, int left, int width, int y,
                               int plane) {
  std::vector<double> row;
  for (int x = left; x < left + width; ++x) {
    for (int s = 0; s < kind.samples; ++s) {
      const bool inside = x < kind.width && y < kind.height;
      if (!kind.planar || s == plane) row.push_back(inside ? numbers(x, y, s) : 0);
    }
  }
  return row;
}

void write_tiles(TIFF* tiff, const Kind& kind, const Numbers& numbers, int plane) {
  constexpr int kSide = 16;
  for (int top = 0; top < kind.height; top += kSide) {
    for (int left = 0; left < kind.width; left += kSide) {
      std::vector<unsigned char> tile;
      for (int y = top; y < top + kSide; ++y) {
        const auto row = packed(numbers_at(kind, numbers, left, kSide, y, plane), kind);
        tile.insert(tile.end(), row.begin(), row.end());
      }
      TIFFWriteTile(tiff, tile.data(), std::uint32_t(left), std::uint32_t(top), 0, std::uint16_t(plane));
    }
  }
}

void write_rows(TIFF* tiff, const Kind& kind, const Numbers& numbers, int plane) {
  for (int y = 0; y < kind.height; ++y) {
    auto row = packed(numbers_at(kind, numbers, 0, kind.width, y, plane), kind);
    TIFFWriteScanline(tiff, row.data(), std::uint32_t(y), std::uint16_t(plane));
  }
}

void write_page(TIFF* tiff, const Kind& kind, const Numbers& numbers,
                const std::function<void(TIFF*)>& more_tags = {}) {
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, kind.width);
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, kind.height);
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, kind.compression);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, kind.photometric);
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, kind.samples);
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, kind.bits);
  TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, kind.format);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, kind.planar ? PLANARCONFIG_SEPARATE : PLANARCONFIG_CONTIG);
  if (!kind.others.empty()) TIFFSetField(tiff, TIFFTAG_EXTRASAMPLES, kind.others.size(), kind.others.data());
  if (kind.tiled) {
    TIFFSetField(tiff, TIFFTAG_TILEWIDTH, 16);
    TIFFSetField(tiff, TIFFTAG_TILELENGTH, 16);
  } else {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 16);
  }
  if (kind.compression == COMPRESSION_JPEG) TIFFSetField(tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
  if (more_tags) more_tags(tiff);
  for (int plane = 0; plane < (kind.planar ? kind.samples : 1); ++plane) {
    if (kind.tiled)
      write_tiles(tiff, kind, numbers, plane);
    else
      write_rows(tiff, kind, numbers, plane);
  }
  TIFFWriteDirectory(tiff);
}

void write_tiff(const std::filesystem::path& path, const Kind& kind, const Numbers& numbers,
                const std::function<void(TIFF*)>& more_tags = {}) {
  TIFF* tiff = TIFFOpen(path.c_str(), kind.mode);
  write_page(tiff, kind, numbers, more_tags);
  TIFFClose(tiff);
}

/// Numbers all over their range, the ends among them; those of floats have few digits.
Numbers any_numbers(const Kind& kind) {
  return [kind](int x, int y, int sample) {
    const double part = double((x * 7 + y * 11 + sample * 5) % 33) / 32;
    return kind.floats() ? part : std::floor(part * kind.largest());
  };
}

Image written_and_read(const Kind& kind, const Numbers& numbers, ImageFileInfo* info = nullptr,
                       const std::function<void(TIFF*)>& more_tags = {}) {
  const TempDir dir;
  write_tiff(dir / "a.tif", kind, numbers, more_tags);
  return read_image(dir / "a.tif", info);
}

/// The colours of the one pixel of a picture with these numbers.
std::vector<float> pixel(Kind kind, const std::vector<double>& numbers,
                         const std::function<void(TIFF*)>& more_tags = {}) {
  kind.width = kind.height = 1;
  kind.samples = int(numbers.size());
  return written_and_read(
             kind, [&](int, int, int s) { return numbers[std::size_t(s)]; }, nullptr, more_tags)
      .samples;
}

void expect_samples(const std::vector<float>& samples, const std::vector<float>& expected,
                    double tolerance = 1e-4) {
  ASSERT_EQ(samples.size(), expected.size());
  for (std::size_t i = 0; i < samples.size(); ++i) EXPECT_NEAR(samples[i], expected[i], tolerance) << i;
}

/// Every sample is the stored number on the scale 0..255.
void expect_as_written(const Kind& kind) {
  SCOPED_TRACE(testing::Message() << kind.samples << " of " << kind.bits << " bits, format " << kind.format
                                  << ", planar " << kind.planar << ", tiled " << kind.tiled
                                  << ", compression " << kind.compression << ", mode " << kind.mode);
  const Numbers numbers = any_numbers(kind);
  ImageFileInfo info;
  const Image image = written_and_read(kind, numbers, &info);
  ASSERT_EQ(image.width, kind.width);
  ASSERT_EQ(image.height, kind.height);
  ASSERT_EQ(image.channels, kind.samples);
  EXPECT_EQ(info.samples, kind.floats() || kind.bits == 32 ? SampleType::f32
                          : kind.bits > 8                  ? SampleType::u16
                                                           : SampleType::u8);
  for (int y = 0; y < kind.height; ++y)
    for (int x = 0; x < kind.width; ++x)
      for (int s = 0; s < kind.samples; ++s)
        ASSERT_NEAR(image.at(x, y, s), numbers(x, y, s) * 255 / kind.largest(), 1e-4)
            << x << " " << y << " " << s;
}

/// In strips and tiles, sample by sample and pixel by pixel.
void expect_as_written_anyhow(Kind kind) {
  for (const bool planar : {false, true}) {
    for (const bool tiled : {false, true}) {
      kind.planar = planar;
      kind.tiled = tiled;
      expect_as_written(kind);
    }
  }
}

TEST(Tiff, SamplesOfAllSizesAreReadAsWritten) {
  for (const int samples : {1, 3}) {
    const std::uint16_t photometric = samples == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB;
    for (const int bits : {1, 2, 4, 8, 10, 12, 14, 16, 32})
      expect_as_written_anyhow({.photometric = photometric, .samples = samples, .bits = bits});
    for (const int bits : {16, 32, 64})
      expect_as_written_anyhow(
          {.photometric = photometric, .samples = samples, .bits = bits, .format = SAMPLEFORMAT_IEEEFP});
  }
}

TEST(Tiff, AlphaIsReadAsWritten) {
  for (const int samples : {2, 4}) {
    const std::uint16_t photometric = samples == 2 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB;
    for (const int bits : {4, 8, 16}) {
      expect_as_written_anyhow(
          {.photometric = photometric, .samples = samples, .bits = bits, .others = {EXTRASAMPLE_UNASSALPHA}});
    }
    expect_as_written_anyhow({.photometric = photometric,
                              .samples = samples,
                              .bits = 32,
                              .format = SAMPLEFORMAT_IEEEFP,
                              .others = {EXTRASAMPLE_UNASSALPHA}});
  }
}

TEST(Tiff, ByteOrdersBigFilesAndCompressionsAreRead) {
  for (const char* mode : {"wl", "wb", "w8", "wb8"}) {
    for (const int bits : {8, 16, 32}) expect_as_written({.bits = bits, .mode = mode});
  }
  for (const int compression : {COMPRESSION_LZW, COMPRESSION_PACKBITS, COMPRESSION_ADOBE_DEFLATE}) {
    for (const int bits : {8, 16})
      expect_as_written_anyhow({.bits = bits, .compression = std::uint16_t(compression)});
  }
  expect_as_written(
      {.photometric = PHOTOMETRIC_MINISBLACK, .samples = 1, .bits = 1, .compression = COMPRESSION_CCITTFAX4});
}

TEST(Tiff, WhiteMayBeZero) {
  for (const int bits : {1, 4, 8, 16, 32}) {
    const Kind kind{.photometric = PHOTOMETRIC_MINISWHITE, .samples = 1, .bits = bits};
    expect_samples(pixel(kind, {0}), {255});
    expect_samples(pixel(kind, {kind.largest()}), {0});
  }
  const Kind floats{.photometric = PHOTOMETRIC_MINISWHITE, .bits = 32, .format = SAMPLEFORMAT_IEEEFP};
  expect_samples(pixel(floats, {0.25}), {191.25});
}

TEST(Tiff, PremultipliedColoursAreDividedByAlpha) {
  const Kind bytes{.others = {EXTRASAMPLE_ASSOCALPHA}};
  expect_samples(pixel(bytes, {100, 50, 25, 127.5}),
                 {100 * 255 / 127.F, 50 * 255 / 127.F, 25 * 255 / 127.F, 127});
  expect_samples(pixel(bytes, {0, 0, 0, 0}), {0, 0, 0, 0});
  expect_samples(pixel(bytes, {129, 0, 0, 128}), {255, 0, 0, 128});
  const Kind words{.bits = 16, .others = {EXTRASAMPLE_ASSOCALPHA}};
  expect_samples(pixel(words, {25700, 12850, 0, 32896}), {199.21875F, 99.609375F, 0, 128});
  const Kind grey{.photometric = PHOTOMETRIC_MINISBLACK, .others = {EXTRASAMPLE_ASSOCALPHA}};
  expect_samples(pixel(grey, {51, 102}), {127.5F, 102});
  const Kind floats{.bits = 32, .format = SAMPLEFORMAT_IEEEFP, .others = {EXTRASAMPLE_ASSOCALPHA}};
  expect_samples(pixel(floats, {1, 0.5, 0.25, 0.5}), {510, 255, 127.5F, 127.5F});
}

TEST(Tiff, SamplesThatAreNeitherColourNorAlphaAreLeftOut) {
  const std::uint16_t unknown = EXTRASAMPLE_UNSPECIFIED;
  expect_samples(pixel({.others = {unknown, unknown}}, {1, 2, 3, 4, 5}), {1, 2, 3});
  expect_samples(pixel({.others = {unknown, EXTRASAMPLE_UNASSALPHA}}, {1, 2, 3, 4, 5}), {1, 2, 3, 5});
  expect_samples(pixel({.photometric = PHOTOMETRIC_MINISBLACK, .others = {unknown}}, {1, 2}), {1});
  // The only one beside RGB is alpha for everybody.
  expect_samples(pixel({.others = {unknown}}, {1, 2, 3, 4}), {1, 2, 3, 4});
  expect_samples(pixel({}, {1, 2, 3, 4}), {1, 2, 3, 4});
}

TEST(Tiff, PalettesAreResolved) {
  for (const int bits : {1, 2, 4, 8}) {
    for (const int unit : {1, 256, 257}) {  // maps of 8 bits, of 16 with zeros below, and in full
      std::array<std::vector<std::uint16_t>, 3> map;
      for (int i = 0; i < 1 << bits; ++i) {
        for (int c = 0; c < 3; ++c) map[std::size_t(c)].push_back(std::uint16_t((511 - i - c) % 256 * unit));
      }
      const int last = (1 << bits) - 1;
      const auto set_map = [&](TIFF* tiff) {
        TIFFSetField(tiff, TIFFTAG_COLORMAP, map[0].data(), map[1].data(), map[2].data());
      };
      const Kind kind{.photometric = PHOTOMETRIC_PALETTE, .bits = bits};
      expect_samples(pixel(kind, {0}, set_map), {255, 254, 253});
      expect_samples(pixel(kind, {double(last - 1)}, set_map),
                     {float(256 - last), float(255 - last), float((510 - last) % 256)});
    }
  }
}

TEST(Tiff, InksAreColours) {
  for (const int bits : {8, 16}) {
    for (const bool planar : {false, true}) {
      const Kind kind{.photometric = PHOTOMETRIC_SEPARATED, .bits = bits, .planar = planar};
      const double all = kind.largest();
      expect_samples(pixel(kind, {0, 0, 0, 0}), {255, 255, 255});
      expect_samples(pixel(kind, {all, 0, 0, 0}), {0, 255, 255});
      expect_samples(pixel(kind, {0, all / 5, all, all / 5 * 4}), {51, 40.8F, 0});
    }
  }
}

TEST(Tiff, LabIsReadAsSrgb) {
  struct Colour {
    double l, a, b;
    std::vector<float> rgb;
  };
  // Made from sRGB by the definition; primaries of D65.
  for (const Colour& colour :
       {Colour{100, 0, 0, {255, 255, 255}}, Colour{0, 0, 0, {0, 0, 0}}, Colour{53.585, 0, 0, {128, 128, 128}},
        Colour{53.2408, 80.0925, 67.2032, {255, 0, 0}}, Colour{32.2970, 79.1875, -107.8602, {0, 0, 255}}}) {
    const auto wrapped = [](double axis) { return axis < 0 ? axis + 256 : axis; };
    const Kind lab{.photometric = PHOTOMETRIC_CIELAB, .bits = 16};
    expect_samples(pixel(lab, {colour.l * 655.35, wrapped(colour.a) * 256, wrapped(colour.b) * 256}),
                   colour.rgb, 0.6);
    const Kind icc{.photometric = PHOTOMETRIC_ICCLAB, .bits = 16};
    expect_samples(pixel(icc, {colour.l * 655.35, (colour.a + 128) * 256, (colour.b + 128) * 256}),
                   colour.rgb, 0.6);
  }
  expect_samples(pixel({.photometric = PHOTOMETRIC_CIELAB}, {255, 0, 0}), {255, 255, 255}, 0.1);
}

TEST(Tiff, LogarithmicColoursAreLinearFloats) {
  const Kind kind{.photometric = PHOTOMETRIC_LOGLUV,
                  .bits = 32,
                  .format = SAMPLEFORMAT_IEEEFP,
                  .compression = COMPRESSION_SGILOG};
  const auto as_floats = [](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_SGILOGDATAFMT, SGILOGDATAFMT_FLOAT); };
  expect_samples(pixel(kind, {0.950456, 1, 1.088754}, as_floats), {255, 255, 255}, 6);
  expect_samples(pixel(kind, {0.412453 * 3, 0.212671 * 3, 0.019334 * 3}, as_floats), {765, 0, 0}, 12);
}

TEST(Tiff, YcbcrInJpegsIsRead) {
  Kind kind{.photometric = PHOTOMETRIC_YCBCR, .compression = COMPRESSION_JPEG};
  const Numbers ramp = [](int x, int y, int s) { return double(s == 0 ? x * 6 : s == 1 ? y * 12 : 128); };
  for (const bool tiled : {false, true}) {
    kind.tiled = tiled;
    const Image image = written_and_read(kind, ramp);
    ASSERT_EQ(image.channels, 3);
    // Beyond the border, tiles of this test are black, which shines through.
    for (int y = 0; y < 16; ++y)
      for (int x = 0; x < 32; ++x)
        for (int s = 0; s < 3; ++s) ASSERT_NEAR(image.at(x, y, s), ramp(x, y, s), 12) << x << " " << y;
  }
}

TEST(Tiff, IsTurnedByItsOrientation) {
  // Where the first pixel of the file, and its right neighbour, are to be seen in a picture of 4 x 3 pixels.
  struct Place {
    int x, y, right_x, right_y;
  };
  const Place places[] = {{0, 0, 1, 0}, {3, 0, 2, 0}, {3, 2, 2, 2}, {0, 2, 1, 2},
                          {0, 0, 0, 1}, {2, 0, 2, 1}, {2, 3, 2, 2}, {0, 3, 0, 2}};
  const Kind kind{.photometric = PHOTOMETRIC_MINISBLACK, .samples = 1, .width = 4, .height = 3};
  for (int orientation = 1; orientation <= 8; ++orientation) {
    SCOPED_TRACE(orientation);
    const Image image = written_and_read(
        kind, [](int x, int y, int) { return 1.0 + x + 4 * y; }, nullptr,
        [&](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_ORIENTATION, orientation); });
    const Place& place = places[orientation - 1];
    ASSERT_EQ(image.width, orientation <= 4 ? 4 : 3);
    ASSERT_EQ(image.height, orientation <= 4 ? 3 : 4);
    EXPECT_EQ(image.at(place.x, place.y, 0), 1);
    EXPECT_EQ(image.at(place.right_x, place.right_y, 0), 2);
    EXPECT_EQ(image.at(image.width - 1 - place.x, image.height - 1 - place.y, 0), 12);
  }
}

TEST(Tiff, MorePagesAndProfilesAreNoted) {
  const TempDir dir;
  const Kind kind;
  const auto pages_of = [&](const char* mode, std::uint32_t second_page) {
    TIFF* tiff = TIFFOpen((dir / "a.tif").c_str(), mode);
    write_page(tiff, kind, any_numbers(kind),
               [](TIFF* page) { TIFFSetField(page, TIFFTAG_ICCPROFILE, 4, "icc"); });
    write_page(tiff, {.photometric = PHOTOMETRIC_MINISBLACK, .samples = 1, .width = 5}, any_numbers(kind),
               [&](TIFF* page) { TIFFSetField(page, TIFFTAG_SUBFILETYPE, second_page); });
    TIFFClose(tiff);
    ImageFileInfo info;
    EXPECT_EQ(read_image(dir / "a.tif", &info).width, 37);
    return info;
  };
  for (const char* mode : {"w", "w8"}) {
    EXPECT_TRUE(pages_of(mode, FILETYPE_PAGE).more_pages);
    EXPECT_FALSE(pages_of(mode, FILETYPE_REDUCEDIMAGE).more_pages);
    EXPECT_TRUE(pages_of(mode, 0).colour_profile);
  }
  ImageFileInfo info;
  written_and_read(kind, any_numbers(kind), &info);
  EXPECT_FALSE(info.more_pages);
  EXPECT_FALSE(info.colour_profile);
}

/// The message of the error, which must be one line and the only one; empty if the file is read.
std::string tiff_refusal(const std::filesystem::path& path) {
  testing::internal::CaptureStderr();
  std::string message;
  try {
    const Image image = read_image(path);
    EXPECT_EQ(image.samples.size(), image.row_size() * std::size_t(image.height));
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kInput);
    message = e.what();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  return message;
}

TEST(Tiff, KindsThatAreNotReadAreNamed) {
  const TempDir dir;
  const auto refusal_of = [&](const Kind& kind, const std::function<void(TIFF*)>& more_tags = {}) {
    write_tiff(
        dir / "a.tif", kind, [](int, int, int) { return 1; }, more_tags);
    return tiff_refusal(dir / "a.tif");
  };
  EXPECT_NE(refusal_of({.bits = 24}).find("TIFF of 24-bit integers"), std::string::npos);
  EXPECT_NE(refusal_of({.bits = 16, .format = SAMPLEFORMAT_INT}).find("integers with a sign"),
            std::string::npos);
  EXPECT_NE(refusal_of({.bits = 64, .format = SAMPLEFORMAT_COMPLEXIEEEFP}).find("complex"),
            std::string::npos);
  EXPECT_NE(refusal_of({.photometric = PHOTOMETRIC_CFA, .samples = 1}).find("camera"), std::string::npos);
  EXPECT_NE(refusal_of({.photometric = PHOTOMETRIC_ITULAB}).find("interpretation 10"), std::string::npos);
  EXPECT_NE(refusal_of({.photometric = PHOTOMETRIC_CIELAB, .bits = 32}).find("Lab"), std::string::npos);
  EXPECT_NE(refusal_of({.photometric = PHOTOMETRIC_SEPARATED, .samples = 4},
                       [](TIFF* tiff) { TIFFSetField(tiff, TIFFTAG_INKSET, INKSET_MULTIINK); })
                .find("inks"),
            std::string::npos);
}

/// A TIFF of one strip whose directory comes before its pixels, so that these can be missing.
std::string directory_first(std::uint32_t width, std::uint32_t height, std::uint32_t compression,
                            const std::string& pixels) {
  const auto u16 = [](std::uint32_t value) { return std::string{char(value), char(value >> 8)}; };
  const auto u32 = [&](std::uint32_t value) { return u16(value & 0xffff) + u16(value >> 16); };
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> tags{
      {TIFFTAG_IMAGEWIDTH, width},
      {TIFFTAG_IMAGELENGTH, height},
      {TIFFTAG_BITSPERSAMPLE, 8},
      {TIFFTAG_COMPRESSION, compression},
      {TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK},
      {TIFFTAG_STRIPOFFSETS, 8 + 2 + 9 * 12 + 4},
      {TIFFTAG_SAMPLESPERPIXEL, 1},
      {TIFFTAG_ROWSPERSTRIP, height},
      {TIFFTAG_STRIPBYTECOUNTS, std::uint32_t(pixels.size())}};
  std::string text = std::string("II*\0", 4) + u32(8) + u16(std::uint32_t(tags.size()));
  for (const auto& [number, value] : tags) text += u16(number) + u16(TIFF_LONG) + u32(1) + u32(value);
  return text + u32(0) + pixels;
}

TEST(Tiff, MissingPixelsAreTold) {
  const TempDir dir;
  const std::string whole = directory_first(10, 10, COMPRESSION_NONE, std::string(100, 'x'));
  test::write_text(dir / "a.tif", whole);
  EXPECT_EQ(read_image(dir / "a.tif").at(9, 9, 0), 'x');
  for (std::size_t length = 0; length < whole.size(); length += 3) {
    test::write_text(dir / "a.tif", whole.substr(0, length));
    const std::string why = tiff_refusal(dir / "a.tif");
    EXPECT_NE(why, "") << length;
    // Without a word of libtiff: it has not been asked for pixels.
    if (length + 100 >= whole.size()) {
      EXPECT_TRUE(why.ends_with("the file is damaged or cut short")) << why;
    }
  }
  test::write_text(dir / "a.tif", directory_first(10, 10, COMPRESSION_NONE, std::string(50, 'x')));
  EXPECT_NE(tiff_refusal(dir / "a.tif").find("cut short"), std::string::npos);
}

TEST(Tiff, ErrorsAreOneLineOfWhatMatters) {
  const TempDir dir;
  const Kind kind{
      .photometric = PHOTOMETRIC_SEPARATED, .samples = 4, .compression = COMPRESSION_LZW, .mode = "wl"};
  write_tiff(dir / "a.tif", kind, any_numbers(kind), [](TIFF* tiff) {
    TIFFSetField(tiff, TIFFTAG_NUMBEROFINKS, 4);
    TIFFSetField(tiff, TIFFTAG_INKNAMES, 8, "c\0m\0y\0k");
  });
  std::string bytes = test::read_text(dir / "a.tif");
  const auto replace = [&](const std::string& from, const std::string& to) {
    ASSERT_NE(bytes.rfind(from), std::string::npos);
    bytes.replace(bytes.rfind(from), from.size(), to);
  };
  replace(std::string("\x4e\1\3\0\1\0\0\0\4", 9), std::string("\x4e\1\3\0\1\0\0\0\5", 9));  // five inks
  test::write_text(dir / "a.tif", bytes);
  EXPECT_EQ(tiff_refusal(dir / "a.tif"), "") << "it does not matter";
  bytes.replace(8, 60, std::string(60, '\xff'));
  test::write_text(dir / "a.tif", bytes);
  EXPECT_NE(tiff_refusal(dir / "a.tif"), "") << "no pixels";
  EXPECT_EQ(tiff_refusal(dir / "a.tif").find("NumberOfInks"), std::string::npos);
  replace(std::string("\x11\1\4\0", 4), std::string("\x10\1\4\0", 4));  // no strips, which makes it an error
  test::write_text(dir / "a.tif", bytes);
  EXPECT_NE(tiff_refusal(dir / "a.tif").find("NumberOfInks"), std::string::npos);
}

TEST(Tiff, HugeHeadersAreRefused) {
  const TempDir dir;
  test::write_text(dir / "a.tif", directory_first(100000, 100000, COMPRESSION_NONE, "x"));
  EXPECT_NE(tiff_refusal(dir / "a.tif").find("100000x100000"), std::string::npos);
  for (const int compression : {COMPRESSION_NONE, COMPRESSION_LZW, COMPRESSION_ADOBE_DEFLATE}) {
    test::write_text(dir / "a.tif", directory_first(16000, 16000, std::uint32_t(compression), "x"));
    EXPECT_NE(tiff_refusal(dir / "a.tif").find("cut short"), std::string::npos);
  }
  test::write_text(dir / "a.tif", directory_first(10, 10, 34712, "x"));  // JPEG 2000
  EXPECT_NE(tiff_refusal(dir / "a.tif").find("compression 34712"), std::string::npos);
}

TEST(Tiff, DamageNeverDoesMoreThanFail) {
  const TempDir dir;
  std::mt19937 random(5);
  const Kind kinds[] = {{},
                        {.bits = 16, .others = {}, .planar = true},
                        {.bits = 32, .format = SAMPLEFORMAT_IEEEFP, .tiled = true},
                        {.photometric = PHOTOMETRIC_MINISWHITE, .samples = 1, .bits = 4},
                        {.photometric = PHOTOMETRIC_SEPARATED, .samples = 4, .compression = COMPRESSION_LZW},
                        {.photometric = PHOTOMETRIC_YCBCR, .compression = COMPRESSION_JPEG},
                        {.samples = 4, .others = {EXTRASAMPLE_ASSOCALPHA}, .planar = true, .tiled = true},
                        {.photometric = PHOTOMETRIC_CIELAB, .compression = COMPRESSION_ADOBE_DEFLATE},
                        {.mode = "w8"}};
  for (const Kind& kind : kinds) {
    write_tiff(dir / "a.tif", kind, any_numbers(kind));
    const std::string bytes = test::read_text(dir / "a.tif");
    for (int round = 0; round < 60; ++round) {
      std::string damaged = bytes;
      for (int i = 0; i < 3; ++i) {
        // Half of the damage goes to the directory, which is at the end.
        const std::size_t range = round % 2 == 0 ? std::min<std::size_t>(250, bytes.size()) : bytes.size();
        damaged[bytes.size() - 1 - random() % range] ^= static_cast<char>(1 << random() % 8);
      }
      test::write_text(dir / "b.tif", damaged);
      tiff_refusal(dir / "b.tif");
    }
    for (std::size_t length = 0; length < bytes.size(); length += 97) {
      test::write_text(dir / "b.tif", bytes.substr(0, length));
      EXPECT_NE(tiff_refusal(dir / "b.tif"), "") << length;
    }
  }
}

}  // namespace
}  // namespace knotreel::image
