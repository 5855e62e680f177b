// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/write_image.h"

#include <gtest/gtest.h>
#include <tiffio.h>

#include <functional>

#include "knotreel/base/error.h"
#include "knotreel/image/read_image.h"
#include "support/pictures.h"
#include "support/temp_dir.h"

namespace knotreel::image {
namespace {

using test::largest_difference;
using test::TempDir;

struct Case {
  const char* name;
  int channels;
  SampleType samples;
};

ErrorKind kind_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    return e.kind();
  }
  ADD_FAILURE() << "nothing was thrown";
  return ErrorKind::kInternal;
}

class WriteAndRead : public testing::TestWithParam<Case> {};

TEST_P(WriteAndRead, GivesTheSamePicture) {
  const auto [name, channels, samples] = GetParam();
  const TempDir dir;
  const bool eight = samples == SampleType::u8;
  const Image image =
      eight ? test::random_8bit_picture(37, 23, channels, 1) : test::random_picture(37, 23, channels, 1);
  write_image(dir / name, image, samples);
  ImageFileInfo info;
  const Image back = read_image(dir / name, &info);
  // Floats are divided by 255 and multiplied again.
  EXPECT_LE(largest_difference(image, back), samples == SampleType::f32 ? 1e-4 : 0);
  EXPECT_EQ(info.samples, samples);
  EXPECT_EQ(info.file_bytes, std::filesystem::file_size(dir / name));
  EXPECT_EQ(dir.entries(), 1u);
}

std::string case_name(const testing::TestParamInfo<Case>& parameter) {
  static const char* const kDepths[] = {"u8", "u16", "f32"};
  const Case& c = parameter.param;
  return std::string(c.name).substr(2) + "_" + std::to_string(c.channels) + "_" + kDepths[int(c.samples)];
}

INSTANTIATE_TEST_SUITE_P(
    LosslessFormats, WriteAndRead,
    testing::Values(Case{"a.png", 1, SampleType::u8}, Case{"a.png", 2, SampleType::u8},
                    Case{"a.png", 3, SampleType::u8}, Case{"a.png", 4, SampleType::u8},
                    Case{"a.png", 1, SampleType::u16}, Case{"a.png", 2, SampleType::u16},
                    Case{"a.png", 3, SampleType::u16}, Case{"a.PNG", 4, SampleType::u16},
                    Case{"a.pgm", 1, SampleType::u8}, Case{"a.pgm", 1, SampleType::u16},
                    Case{"a.ppm", 3, SampleType::u8}, Case{"a.ppm", 3, SampleType::u16},
                    Case{"a.pam", 1, SampleType::u8}, Case{"a.pam", 2, SampleType::u16},
                    Case{"a.pam", 3, SampleType::u8}, Case{"a.pam", 4, SampleType::u16},
                    Case{"a.pfm", 1, SampleType::f32}, Case{"a.pfm", 3, SampleType::f32},
                    Case{"a.tiff", 1, SampleType::u8}, Case{"a.tif", 3, SampleType::u8},
                    Case{"a.tiff", 2, SampleType::u8}, Case{"a.tiff", 4, SampleType::u8},
                    Case{"a.tiff", 2, SampleType::u16}, Case{"a.tiff", 3, SampleType::u16},
                    Case{"a.tiff", 4, SampleType::u16}, Case{"a.tiff", 1, SampleType::f32},
                    Case{"a.tiff", 2, SampleType::f32}, Case{"a.tiff", 4, SampleType::f32},
                    Case{"a.tiff", 3, SampleType::f32}, Case{"a.bmp", 3, SampleType::u8},
                    Case{"a.webp", 3, SampleType::u8}),
    case_name);

TEST(WriteImage, AlphaIsKeptOrRefused) {
  const TempDir dir;
  for (const char* name : {"a.png", "a.ppm", "a.pam", "a.tiff", "a.webp", "a.bmp", "a.jpg"}) {
    for (const int channels : {2, 4}) {
      Image image = make_image(16, 16, channels);
      for (std::size_t i = 0; i < image.samples.size(); ++i)
        image.samples[i] = float(i % std::size_t(channels) + 1 == std::size_t(channels) ? i % 256 : 100);
      try {
        write_image(dir / name, image);
      } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("alpha"), std::string::npos) << name;
        continue;
      }
      const Image back = read_image(dir / name);
      ASSERT_EQ(back.channels, channels) << name;
      for (int x = 0; x < 16; ++x)
        EXPECT_NEAR(back.at(x, 5, channels - 1), image.at(x, 5, channels - 1), 2) << name;
    }
  }
}

TEST(WriteImage, TiffSaysWhatItsSamplesAre) {
  const TempDir dir;
  for (const SampleType samples : {SampleType::u8, SampleType::u16, SampleType::f32}) {
    for (const int channels : {1, 2, 3, 4}) {
      write_image(dir / "a.tiff", make_image(9, 7, channels), samples);
      const std::unique_ptr<TIFF, void (*)(TIFF*)> tiff(TIFFOpen((dir / "a.tiff").c_str(), "r"), TIFFClose);
      ASSERT_NE(tiff, nullptr);
      std::uint16_t photometric = 0;
      std::uint16_t count = 0;
      const std::uint16_t* others = nullptr;
      TIFFGetField(tiff.get(), TIFFTAG_PHOTOMETRIC, &photometric);
      TIFFGetField(tiff.get(), TIFFTAG_EXTRASAMPLES, &count, &others);
      EXPECT_EQ(photometric, channels < 3 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
      ASSERT_EQ(count, channels % 2 == 0 ? 1 : 0) << channels;
      EXPECT_TRUE(count == 0 || others[0] == EXTRASAMPLE_UNASSALPHA);
    }
  }
}

TEST(WriteImage, JpegIsClose) {
  const TempDir dir;
  Image image = make_image(64, 48, 3);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      image.at(x, y, 0) = float(4 * x);
      image.at(x, y, 2) = float(5 * y);
    }
  }
  write_image(dir / "a.jpg", image);
  EXPECT_LE(largest_difference(image, read_image(dir / "a.jpg")), 24);
}

TEST(WriteImage, RoundsAndClamps) {
  const TempDir dir;
  write_image(dir / "a.png", Image{5, 1, 1, {-3, 0.49F, 0.5F, 254.6F, 300}});
  EXPECT_EQ(read_image(dir / "a.png").samples, (std::vector<float>{0, 0, 1, 255, 255}));
  write_image(dir / "a.png", Image{1, 1, 1, {NAN}});
  EXPECT_EQ(read_image(dir / "a.png").samples, (std::vector<float>{0}));
}

TEST(WriteImage, FloatsAreNotClamped) {
  const TempDir dir;
  write_image(dir / "a.pfm", Image{1, 2, 1, {-255, 510}}, SampleType::f32);
  EXPECT_EQ(read_image(dir / "a.pfm").samples, (std::vector<float>{-255, 510}));
}

TEST(RowWriter, AnyDivisionIntoBandsGivesTheSameBytes) {
  const TempDir dir;
  const Image image = test::random_8bit_picture(50, 31, 3, 5);
  for (const std::string extension : {"png", "ppm", "pam", "tiff"}) {
    write_image(dir / ("whole." + extension), image);
    const auto writer =
        open_image_writer(dir / ("bands." + extension), {50, 31, 3, SampleType::u8, std::nullopt});
    for (int y = 0, count = 1; y < 31; y += count, count = std::min(count + 1, 31 - y)) {
      writer->write(std::span(image.samples).subspan(std::size_t(y) * 150, std::size_t(count) * 150), count);
    }
    writer->finish();
    EXPECT_EQ(test::read_text(dir / ("whole." + extension)), test::read_text(dir / ("bands." + extension)));
  }
}

TEST(RowWriter, NothingIsLeftOfAnUnfinishedPicture) {
  const TempDir dir;
  for (const std::string name : {"a.png", "a.ppm", "a.pfm", "a.tiff"}) {
    const SampleType samples = name == "a.pfm" ? SampleType::f32 : SampleType::u8;
    const auto writer = open_image_writer(dir / name, {4, 4, 3, samples, std::nullopt});
    writer->write(std::vector<float>(12), 1);
    EXPECT_EQ(kind_of([&] { writer->finish(); }), ErrorKind::kInvalidArgument);
  }
  EXPECT_EQ(dir.entries(), 0u);
}

TEST(RowWriter, RowsOfAnotherShapeAreRefused) {
  const TempDir dir;
  const auto writer = open_image_writer(dir / "a.png", {4, 2, 1, SampleType::u8, std::nullopt});
  EXPECT_EQ(kind_of([&] { writer->write(std::vector<float>(3), 1); }), ErrorKind::kInvalidArgument);
  EXPECT_EQ(kind_of([&] { writer->write(std::vector<float>(12), 3); }), ErrorKind::kInvalidArgument);
}

TEST(WriteImage, WhatAFormatCannotHoldIsRefused) {
  const TempDir dir;
  const auto open = [&](const std::string& name, int channels, SampleType samples) {
    return kind_of([&] { open_image_writer(dir / name, {4, 4, channels, samples, std::nullopt}); });
  };
  EXPECT_EQ(open("a.xyz", 3, SampleType::u8), ErrorKind::kInvalidArgument);
  EXPECT_EQ(open("a", 3, SampleType::u8), ErrorKind::kInvalidArgument);
  EXPECT_EQ(open("a.jpg", 4, SampleType::u8), ErrorKind::kInvalidArgument);
  EXPECT_EQ(open("a.jpg", 3, SampleType::u16), ErrorKind::kInvalidArgument);
  EXPECT_EQ(open("a.png", 3, SampleType::f32), ErrorKind::kInvalidArgument);
  EXPECT_EQ(open("a.ppm", 4, SampleType::u8), ErrorKind::kInvalidArgument);
  EXPECT_EQ(open("a.webp", 2, SampleType::u8), ErrorKind::kInvalidArgument);
  EXPECT_EQ(open("a.pfm", 3, SampleType::u8), ErrorKind::kInvalidArgument);
  EXPECT_EQ(open("a.pgm", 3, SampleType::u8), ErrorKind::kInvalidArgument);
  EXPECT_EQ(dir.entries(), 0u);
}

TEST(WriteImage, SidesThatAFormatCannotTellAreRefusedAtOnce) {
  const TempDir dir;
  const auto check = [&](const std::string& name, int width, int height) {
    check_image_spec(dir / name, {width, height, 1, SampleType::u8, std::nullopt});
  };
  EXPECT_NO_THROW(check("a.jpg", 65500, 1));
  EXPECT_NO_THROW(check("a.webp", 1, 16383));
  EXPECT_NO_THROW(check("a.png", 65501, 1));
  EXPECT_EQ(kind_of([&] { check("a.jpg", 65501, 1); }), ErrorKind::kInvalidArgument);
  EXPECT_EQ(kind_of([&] { check("a.webp", 1, 16384); }), ErrorKind::kInvalidArgument);
  EXPECT_EQ(kind_of([&] {
              open_image_writer(dir / "a.jpg", {65501, 1, 1, SampleType::u8, std::nullopt});
            }),
            ErrorKind::kInvalidArgument);
  EXPECT_EQ(dir.entries(), 0u);
}

TEST(WriteImage, LargestSidesCanBeWritten) {
  const TempDir dir;
  write_image(dir / "a.jpg", make_image(65500, 1, 1));
  write_image(dir / "a.webp", make_image(1, 16383, 3));
  EXPECT_EQ(read_image(dir / "a.jpg").width, 65500);
  EXPECT_EQ(read_image(dir / "a.webp").height, 16383);
}

TEST(WriteImage, NamesOfPnmSayHowManyChannelsThereAre) {
  const TempDir dir;
  const Image grey = test::random_8bit_picture(7, 5, 1, 3);
  for (const SampleType samples : {SampleType::u8, SampleType::u16}) {
    write_image(dir / "a.ppm", grey, samples);
    EXPECT_TRUE(test::read_text(dir / "a.ppm").starts_with("P6"));
    const Image back = read_image(dir / "a.ppm");
    for (int c = 0; c < 3; ++c) EXPECT_EQ(back.at(4, 3, c), grey.at(4, 3, 0));
  }
  write_image(dir / "a.pnm", grey);
  EXPECT_TRUE(test::read_text(dir / "a.pnm").starts_with("P5"));
  write_image(dir / "a.pnm", test::random_8bit_picture(7, 5, 3, 3));
  EXPECT_TRUE(test::read_text(dir / "a.pnm").starts_with("P6"));
}

TEST(WriteImage, AFullDiskIsAnOutputError) {
  const Image image = test::random_8bit_picture(300, 300, 3, 1);
  for (const ImageFormat format : {ImageFormat::kPng, ImageFormat::kPnm, ImageFormat::kTiff}) {
    EXPECT_EQ(kind_of([&] {
                const auto writer = open_image_writer("/dev/full", {300, 300, 3, SampleType::u8, format});
                writer->write(image.samples, 300);
                writer->finish();
              }),
              ErrorKind::kOutput);
  }
  EXPECT_EQ(kind_of([&] { write_image("/nonexistent/a.png", image); }), ErrorKind::kOutput);
}

}  // namespace
}  // namespace knotreel::image
