// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/read_image.h"

#include <gtest/gtest.h>
#include <png.h>

#include <cstring>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <random>

#include "knotreel/base/error.h"
#include "knotreel/image/write_image.h"
#include "support/pictures.h"
#include "support/temp_dir.h"

namespace knotreel::image {
namespace {

using test::TempDir;
using test::write_text;

/// The message of the error; empty and a failure if the file is read.
std::string refusal(const std::filesystem::path& path) {
  testing::internal::CaptureStderr();
  std::string message;
  try {
    read_image(path);
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kInput);
    message = e.what();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "a codec wrote to standard error";
  EXPECT_TRUE(message.starts_with("cannot read image '" + path.string() + "': ")) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);
  return message;
}

std::vector<float> samples_of(const TempDir& dir, const std::string& name, const std::string& text) {
  write_text(dir / name, text);
  return read_image(dir / name).samples;
}

TEST(ReadImage, NetpbmPlainAndRaw) {
  const TempDir dir;
  const std::vector<float> bits{255, 0, 0, 255};
  EXPECT_EQ(samples_of(dir, "a", "P1\n# comment\n2 2\n0 1\n10\n"), bits);
  EXPECT_EQ(samples_of(dir, "a", std::string("P4 2 2\n\x40\x80", 9)), bits);
  EXPECT_EQ(samples_of(dir, "a", "P2 2 1 15\n0 15\n"), (std::vector<float>{0, 255}));
  EXPECT_EQ(samples_of(dir, "a", "P3 1 1 255 1 2 3"), (std::vector<float>{1, 2, 3}));
  EXPECT_EQ(samples_of(dir, "a", "P6\n1 1\n255\nabc"), (std::vector<float>{'a', 'b', 'c'}));
  EXPECT_EQ(samples_of(dir, "a", std::string("P5 1 1 65535 \xff\xff", 15)), (std::vector<float>{255}));
}

TEST(ReadImage, ColourProfilesAreNoted) {
  const TempDir dir;
  const Image image = test::random_8bit_picture(8, 8, 3, 1);
  for (const char* name : {"a.png", "a.jpg", "a.tiff", "a.webp", "a.bmp", "a.ppm"}) {
    write_image(dir / name, image);
    ImageFileInfo info;
    read_image(dir / name, &info);
    EXPECT_FALSE(info.colour_profile) << name;
  }
  // With a profile: a PNG by libpng, a JPEG by an APP2 segment after the first marker.
  std::FILE* file = std::fopen((dir / "p.png").c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop header = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_benign_errors(png, 1);  // the profile is no real one
  png_set_IHDR(png, header, 1, 1, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
               PNG_FILTER_TYPE_DEFAULT);
  png_write_info_before_PLTE(png, header);
  const std::string chunk = std::string("name\0\0", 6) + "not compressed";
  png_write_chunk(png, reinterpret_cast<png_const_bytep>("iCCP"),
                  reinterpret_cast<png_const_bytep>(chunk.data()), chunk.size());
  png_byte row[3] = {1, 2, 3};
  png_write_row(png, row);
  png_write_end(png, nullptr);
  png_destroy_write_struct(&png, &header);
  std::fclose(file);
  std::ifstream plain(dir / "a.jpg", std::ios::binary);
  std::string jpeg((std::istreambuf_iterator<char>(plain)), {});
  jpeg.insert(2, std::string("\xff\xe2\x00\x12", 4) + "ICC_PROFILE" + std::string("\0\1\1xx", 5));
  write_text(dir / "p.jpg", jpeg);
  for (const char* name : {"p.png", "p.jpg"}) {
    ImageFileInfo info;
    read_image(dir / name, &info);
    EXPECT_TRUE(info.colour_profile) << name;
  }
}

/// A picture of two bits per pixel with a palette of four colours, by libpng itself.
/// @param rows  of packed pixels. @param alpha  of the first two colours, or null
void write_palette_png(const std::string& path, png_uint_32 width,
                       const std::vector<std::vector<png_byte>>& rows, const png_byte* alpha) {
  std::FILE* file = std::fopen(path.c_str(), "wb");
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_init_io(png, file);
  png_set_IHDR(png, info, width, png_uint_32(rows.size()), 2, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  const png_color palette[] = {{255, 0, 0}, {0, 255, 0}, {0, 0, 255}, {9, 9, 9}};
  png_set_PLTE(png, info, palette, 4);
  if (alpha != nullptr) png_set_tRNS(png, info, alpha, 2, nullptr);
  png_write_info(png, info);
  for (const std::vector<png_byte>& row : rows) png_write_row(png, row.data());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  std::fclose(file);
}

TEST(ReadImage, PngPalettesTransparencyAndSmallDepths) {
  const TempDir dir;
  const png_byte alpha[] = {255, 128};
  write_palette_png(dir / "p.png", 4, {{0b00011011}}, alpha);
  const Image image = read_image(dir / "p.png");
  EXPECT_EQ(image.channels, 4);
  EXPECT_EQ(image.samples,
            (std::vector<float>{255, 0, 0, 255, 0, 255, 0, 128, 0, 0, 255, 255, 9, 9, 9, 255}));
}

TEST(ReadImage, AFlatPaletteIsLargerByFarThanItsFile) {
  const TempDir dir;
  write_palette_png(dir / "p.png", 1600, std::vector(1200, std::vector<png_byte>(400, 0b10101010)), nullptr);
  const Image image = read_image(dir / "p.png");
  EXPECT_EQ(image.width, 1600);
  EXPECT_EQ(image.at(1599, 1199, 2), 255);
}

TEST(ReadImage, KindsThatAreNotReadAreNamed) {
  const TempDir dir;
  const std::string webp = std::string("RIFF\x24\0\0\0WEBPVP8X\x0a\0\0\0", 20);
  const std::string size = std::string("\0\0\0\x0f\0\0\x07\0\0", 9);
  write_text(dir / "moving.webp", webp + '\x12' + size);
  EXPECT_NE(refusal(dir / "moving.webp").find("animated WebP"), std::string::npos);
  write_text(dir / "still.webp", webp + '\x10' + size);
  EXPECT_EQ(refusal(dir / "still.webp").find("animated WebP"), std::string::npos);
  write_text(dir / "os2.bmp",
             std::string("BM\x26\0\0\0\0\0\0\0\x1a\0\0\0\x0c\0\0\0\x02\0\x02\0\x01\0\x18\0", 26) +
                 std::string(12, 'x'));
  EXPECT_NE(refusal(dir / "os2.bmp").find("OS/2"), std::string::npos);
}

TEST(ReadImage, JpegIsTurnedByItsExifOrientation) {
  const TempDir dir;
  cv::Mat mat(16, 32, CV_8UC3, cv::Scalar(0, 0, 0));
  mat(cv::Rect(0, 0, 16, 16)).setTo(cv::Scalar(255, 255, 255));  // left half white
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", mat, jpeg);
  // APP1 with one directory entry: orientation 6, to be turned clockwise by 90 degrees.
  static constexpr char kExif[] =
      "\xff\xe1\x00\x22"
      "Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
  std::string bytes(jpeg.begin(), jpeg.end());
  bytes.insert(2, std::string(kExif, 36));
  write_text(dir / "a.jpg", bytes);
  const Image image = read_image(dir / "a.jpg");
  EXPECT_EQ(image.width, 16);
  EXPECT_EQ(image.height, 32);
  EXPECT_GT(image.at(8, 4, 0), 250) << "what was left is on top";
  EXPECT_LT(image.at(8, 28, 0), 5);
}

TEST(ReadImage, GreyJpegStaysGrey) {
  const TempDir dir;
  write_image(dir / "a.jpg", Image{8, 8, 1, std::vector<float>(64, 77)});
  EXPECT_EQ(read_image(dir / "a.jpg").channels, 1);
}

TEST(ReadImage, MissingAndUnknownFilesSayWhy) {
  const TempDir dir;
  EXPECT_NE(refusal(dir / "missing.png").find("No such file"), std::string::npos);
  EXPECT_NE(refusal(dir.path()).find("directory"), std::string::npos);
  write_text(dir / "empty.png", "");
  EXPECT_NE(refusal(dir / "empty.png").find("empty"), std::string::npos);
  write_text(dir / "text.png", "hello world, I am no picture");
  EXPECT_NE(refusal(dir / "text.png").find("known format"), std::string::npos);
}

TEST(ReadImage, HugeHeadersAreRefusedBeforeMemoryIsTaken) {
  const TempDir dir;
  for (const std::string text :
       {"P6 100000 100000 255 ", "P5 16000 16000 255 ", "P3 16000 16000 255 ", "P1 16000 16000 ",
        "PF 16000 16000 -1 ", "P6 99999999999 1 255 ", "P5 0 5 255 "}) {
    write_text(dir / "a", text);
    refusal(dir / "a");
  }
  // A BMP of 60000 x 60000 pixels.
  std::string bmp(54, '\0');
  bmp.replace(0, 2, "BM");
  bmp[14] = 40;
  bmp[18] = bmp[22] = '\x60';
  bmp[19] = bmp[23] = '\xea';
  write_text(dir / "a.bmp", bmp);
  EXPECT_NE(refusal(dir / "a.bmp").find("60000x60000"), std::string::npos);
}

TEST(ReadImage, FloatsThatAreNotFiniteAreRefused) {
  const TempDir dir;
  write_text(dir / "a.pfm", std::string("Pf 1 1 -1.0\n\0\0\xc0\x7f", 16));
  EXPECT_NE(refusal(dir / "a.pfm").find("finite"), std::string::npos);
}

class DamagedFiles : public testing::TestWithParam<const char*> {};

/// A valid file of the format of the parameter.
std::string sound_file(const TempDir& dir, const std::string& name) {
  const bool is_float = name == "a.pfm";
  write_image(dir / name, test::random_8bit_picture(24, 16, 3, 1),
              is_float ? SampleType::f32 : SampleType::u8);
  return test::read_text(dir / name);
}

TEST_P(DamagedFiles, CutShortAnywhereIsAnError) {
  const TempDir dir;
  const std::string bytes = sound_file(dir, GetParam());
  // TIFF and BMP may end in padding, so a handful of last bytes is not needed by every decoder.
  for (std::size_t length = 0; length + 16 < bytes.size(); length += 7) {
    write_text(dir / GetParam(), bytes.substr(0, length));
    refusal(dir / GetParam());
  }
}

TEST_P(DamagedFiles, FlippedBitsNeverDoMoreThanFail) {
  const TempDir dir;
  const std::string bytes = sound_file(dir, GetParam());
  std::mt19937 random(7);
  for (int round = 0; round < 300; ++round) {
    std::string damaged = bytes;
    // Half of the damage goes to the header, where it hurts.
    for (int i = 0; i < 3; ++i) {
      const std::size_t range = round % 2 == 0 ? std::min<std::size_t>(64, bytes.size()) : bytes.size();
      damaged[random() % range] ^= static_cast<char>(1 << random() % 8);
    }
    write_text(dir / GetParam(), damaged);
    testing::internal::CaptureStderr();
    try {
      const Image image = read_image(dir / GetParam());
      EXPECT_EQ(image.samples.size(), image.row_size() * std::size_t(image.height));
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kInput);
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  }
}

std::string extension_of(const testing::TestParamInfo<const char*>& name) {
  return std::string(name.param).substr(2);
}

INSTANTIATE_TEST_SUITE_P(Formats, DamagedFiles,
                         testing::Values("a.png", "a.jpg", "a.tiff", "a.webp", "a.bmp", "a.ppm", "a.pam",
                                         "a.pfm"),
                         extension_of);

}  // namespace
}  // namespace knotreel::image
