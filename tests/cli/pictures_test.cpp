// SPDX-License-Identifier: GPL-3.0-or-later
#include <filesystem>
#include <fstream>

#include "knotreel/image/metrics.h"
#include "knotreel/image/read_image.h"
#include "odd_pictures.h"
#include "program.h"

namespace knotreel {
namespace {

using nlohmann::json;
using test::expect_failure;
using test::expect_success;
using test::read_text;
using test::TempDir;
using test::write_text;

/// Vectorizes a picture and draws it again. @return how close that is.
image::ImageMetrics there_and_back(const TempDir& dir, const std::string& name,
                                   const std::vector<std::string>& options = {}) {
  const std::string picture = (dir / name).string();
  const std::string document = (dir / "there.tcb").string();
  const std::string rendering = (dir / "back.png").string();
  std::vector<std::string> arguments{"vectorize", picture, "-o", document};
  arguments.insert(arguments.end(), options.begin(), options.end());
  expect_success(test::knotreel(arguments));
  expect_success(test::knotreel({"render", document, "-o", rendering, "--depth", "16"}));
  return image::compare_images(image::read_image(picture), image::read_image(rendering));
}

TEST(CliPictures, OfEverySizeComeBackClose) {
  const TempDir dir;
  int channels = 0;
  for (const auto& [width, height] :
       {std::pair(1, 1), {1, 1}, {1, 7}, {7, 1}, {2, 2}, {3, 3}, {5, 4}, {2, 40}, {33, 17}}) {
    channels = channels % 4 + 1;
    SCOPED_TRACE(testing::Message() << width << "x" << height << " with " << channels);
    image::write_image(dir / "in.png", test::smooth_picture(width, height, channels));
    EXPECT_GT(there_and_back(dir, "in.png").psnr, 35);
  }
}

TEST(CliPictures, WithSharpEdgesComeBackClose) {
  const TempDir dir;
  for (int channels = 1; channels <= 4; ++channels) {
    image::write_image(dir / "in.png", test::sharp_picture(64, 48, channels));
    EXPECT_GT(there_and_back(dir, "in.png").psnr, 28) << channels;
  }
}

TEST(CliPictures, OfEveryDepthAndFormatComeBackClose) {
  const TempDir dir;
  image::write_image(dir / "deep.png", test::smooth_picture(40, 30, 3), image::SampleType::u16);
  image::write_image(dir / "deep.tiff", test::smooth_picture(40, 30, 3), image::SampleType::u16);
  image::write_image(dir / "float.pfm", test::smooth_picture(40, 30, 1), image::SampleType::f32);
  image::write_image(dir / "plain.bmp", test::smooth_picture(40, 30, 3));
  image::write_image(dir / "lossy.jpg", test::smooth_picture(40, 30, 3));
  image::write_image(dir / "lossy.webp", test::smooth_picture(40, 30, 3));
  image::write_image(dir / "any.pam", test::smooth_picture(40, 30, 2));
  test::write_palette_png(dir / "palette.png");
  write_text(dir / "cmyk.jpg", test::cmyk_jpeg());
  for (const char* name : {"deep.png", "deep.tiff", "float.pfm", "plain.bmp", "lossy.jpg", "lossy.webp",
                           "any.pam", "palette.png", "cmyk.jpg"}) {
    EXPECT_GT(there_and_back(dir, name).psnr, 35) << name;
  }
}

/// Letters as far as an edge detector can tell: strokes of two pixels.
image::Image text_picture(int width, int height) {
  image::Image image = image::make_image(width, height, 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int glyph = x / 8 * 7 + y / 10 * 13;
      const bool stroke = x % 8 < 2 || (y % 10 < 2 && glyph % 3 != 0) || (x % 8 > 5 && glyph % 5 == 1);
      image.at(x, y, 0) = stroke && y % 10 < 8 ? 15.0F : 240.0F;
    }
  }
  return image;
}

TEST(CliPictures, NoneGetsMoreControlPointsThanAllowed) {
  const TempDir dir;
  image::write_image(dir / "noise.png", test::random_8bit_picture(64, 48, 3, 5));
  image::write_image(dir / "text.png", text_picture(96, 60));
  image::write_image(dir / "sharp.png", test::sharp_picture(60, 60, 3));
  for (const std::string name : {"noise.png", "text.png", "sharp.png"}) {
    for (const auto& [degree, bound] : {std::pair(1, 100), {2, 20}, {2, 100}, {2, 400}, {3, 100}}) {
      SCOPED_TRACE(testing::Message() << name << " degree " << degree << " bound " << bound);
      const auto result = test::knotreel({"vectorize", (dir / name).string(), "-o", (dir / "d.tcb").string(),
                                          "--degree", std::to_string(degree), "--max-control-points",
                                          std::to_string(bound), "--stats", "-"});
      expect_success(result);
      EXPECT_LE(json::parse(result.out)["control_points"], bound);
    }
  }
}

void expect_refused(const TempDir& dir, const std::string& name) {
  SCOPED_TRACE(name);
  const std::size_t before = dir.entries();
  expect_failure(
      test::knotreel({"vectorize", (dir / name).string(), "-o", (dir / "out.tcb").string(), "--stats",
                      (dir / "stats.json").string(), "--debug-dir", (dir / "debug").string()}),
      3);
  EXPECT_EQ(dir.entries(), before) << "no output may be left";
}

TEST(CliHostile, PicturesCutShortAreExit3) {
  const TempDir dir;
  const image::Image picture = test::sharp_picture(64, 48, 3);
  for (const std::string format : {"png", "jpg", "tiff", "webp", "bmp", "ppm"}) {
    const std::string whole = (dir / ("whole." + format)).string();
    image::write_image(whole, picture);
    const std::string bytes = read_text(whole);
    for (const double share : {0.02, 0.3, 0.7}) {
      const std::string name = "short." + format;
      write_text(dir / name, bytes.substr(0, static_cast<std::size_t>(share * double(bytes.size()))));
      expect_refused(dir, name);
    }
  }
}

TEST(CliHostile, WhatIsNoPictureIsExit3) {
  const TempDir dir;
  write_text(dir / "empty.png", "");
  write_text(dir / "text.png", "This is a text, whatever its name says.\n");
  write_text(dir / "zeros.jpg", std::string(4096, '\0'));
  write_text(dir / "signature.png", "\x89PNG\r\n\x1a\n");
  std::filesystem::create_directory(dir / "folder.png");
  for (const char* name :
       {"empty.png", "text.png", "zeros.jpg", "signature.png", "folder.png", "missing.png"}) {
    expect_refused(dir, name);
  }
}

TEST(CliHostile, HugePicturesAreExit3BeforeMemoryIsAsked) {
  const TempDir dir;
  write_text(dir / "huge.png", test::png_header(1000000, 1000000));
  write_text(dir / "wide.png", test::png_header(2147483647, 1));
  write_text(dir / "huge.ppm", "P6 100000 100000 255\n");
  write_text(dir / "overflow.pgm", "P5 4294967297 4294967297 255\n");
  write_text(dir / "nothing.ppm", "P6 0 0 255\n");
  for (const char* name : {"huge.png", "wide.png", "huge.ppm", "overflow.pgm", "nothing.ppm"}) {
    expect_refused(dir, name);
  }
}

/// Documents have no room for what is far beyond white.
TEST(CliPictures, SamplesBeyondAllBoundsAreExit3AtOnce) {
  const test::TempDir dir;
  const auto vectorize = [&](float factor) {
    image::Image image = test::sharp_picture(40, 30, 3);
    for (float& sample : image.samples) sample *= factor;
    image.at(3, 4, 1) = -255 * factor;
    image.at(30, 20, 0) = 255 * factor;
    image::write_image(dir / "large.pfm", image, image::SampleType::f32);
    return test::knotreel({"vectorize", (dir / "large.pfm").string(), "-o", (dir / "o.tcb").string(), "-q"});
  };
  for (const float factor : {1.0F, 300.0F, 9999.0F}) test::expect_success(vectorize(factor));
  // Control colours of noise are far beyond its samples.
  image::Image noise = image::make_image(16, 12, 3);
  for (std::size_t i = 0; i < noise.samples.size(); ++i) noise.samples[i] = i * i % 7 < 3 ? -2.5e6F : 2.5e6F;
  image::write_image(dir / "noise.pfm", noise, image::SampleType::f32);
  test::expect_success(
      test::knotreel({"vectorize", (dir / "noise.pfm").string(), "-o", (dir / "o.tcb").string(), "-q"}));
  std::filesystem::remove(dir / "o.tcb");
  for (const float factor : {10001.0F, 1e6F, 1e30F}) {
    const auto result = vectorize(factor);
    test::expect_failure(result, 3);
    EXPECT_NE(result.err.find("large.pfm"), std::string::npos) << result.err;
    std::filesystem::create_directory(dir / "in");
    std::filesystem::copy_file(dir / "large.pfm", dir / "in/large.pfm",
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_EQ(test::knotreel({"batch", (dir / "in").string(), "-o", (dir / "out").string()}).exit_code, 3);
  }
  EXPECT_FALSE(std::filesystem::exists(dir / "o.tcb"));
}

}  // namespace
}  // namespace knotreel
