// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstring>

#include "clips.h"
#include "knotreel/base/error.h"
#include "knotreel/image/read_image.h"
#include "knotreel/video/turn.h"
#include "support/pictures.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::largest_difference;
using test::TempDir;

struct Exact {
  const char* format;
  int channels;
  int depth;
};

std::ostream& operator<<(std::ostream& out, const Exact& c) {
  return out << (*c.format ? c.format : "nearest") << ", channels " << c.channels << ", depth " << c.depth;
}

class Lossless : public testing::TestWithParam<Exact> {};

TEST_P(Lossless, GivesTheSamePictures) {
  const auto [format, channels, depth] = GetParam();
  const TempDir dir;
  ClipSpec clip = moving_pattern(37, 23, channels, 3);
  clip.info.depth = depth;
  clip.info.pixel_format = format;
  for (unsigned i = 0; i < 3; ++i) {
    clip.images[i] = depth == 8 ? test::random_8bit_picture(37, 23, channels, i)
                                : test::random_picture(37, 23, channels, i);
  }
  const std::string path = dir / "a.mkv";
  write_clip(path, clip, with_codec("ffv1"));
  const WholeClip back = read_clip(path);
  ASSERT_EQ(back.frames.size(), 3u);
  EXPECT_EQ(back.info.depth, depth);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_LE(largest_difference(back.frames[i].image, clip.images[i]), 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Formats, Lossless,
                         testing::Values(Exact{"gray", 1, 8}, Exact{"gray16le", 1, 16}, Exact{"ya8", 2, 8},
                                         Exact{"rgb24", 3, 8}, Exact{"gbrp", 3, 8}, Exact{"rgba", 4, 8},
                                         Exact{"rgb48le", 3, 16}, Exact{"gbrp16le", 3, 16},
                                         Exact{"rgba64le", 4, 16}, Exact{"", 3, 8}, Exact{"", 1, 8}));

TEST(Ffv1, KeepsTinyPicturesOrRefusesThem) {
  const TempDir dir;
  const std::string path = dir / "a.mkv";
  for (const char* format : {"gray", "rgb24"}) {
    const int channels = format == std::string("gray") ? 1 : 3;
    for (unsigned i = 0; i < 49; ++i) {
      const int width = 1 + static_cast<int>(i % 7), height = 1 + static_cast<int>(i / 7);
      ClipSpec clip = moving_pattern(width, height, channels, 1);
      clip.info.pixel_format = format;
      clip.images[0] = test::random_8bit_picture(width, height, channels, i);
      if (std::min(width, height) == 1) {
        EXPECT_THROW(write_clip(path, clip, with_codec("ffv1")), Error);
        continue;
      }
      write_clip(path, clip, with_codec("ffv1"));
      EXPECT_LE(largest_difference(read_clip(path).frames.at(0).image, clip.images[0]), 1e-4)
          << format << " " << width << "x" << height;
    }
  }
}

struct Kept {
  const char* file;
  const char* codec;
  const char* source;
  const char* written;
  int width, height;
  double tolerance;  ///< mean difference
};

std::ostream& operator<<(std::ostream& out, const Kept& c) {
  return out << c.file << ", " << c.codec << ", " << c.source;
}

class PixelFormats : public testing::TestWithParam<Kept> {};

TEST_P(PixelFormats, AreNearestToTheSource) {
  const Kept& c = GetParam();
  const TempDir dir;
  const bool grey = std::string(c.source).starts_with("gray");
  const bool alpha = std::string(c.source).starts_with("yuva");
  ClipSpec clip = moving_pattern(c.width, c.height, grey ? 1 : alpha ? 4 : 3, 3);
  clip.info.pixel_format = c.source;
  clip.info.depth = std::string(c.source).ends_with("10le") ? 10 : 8;
  const std::string path = dir / c.file;
  WriteOptions options = with_codec(c.codec);
  if (options.codec == "h264") options.preset = "medium";  // the tolerance is for formats, not for haste
  write_clip(path, clip, options);
  const WholeClip back = read_clip(path);
  EXPECT_EQ(back.info.pixel_format, c.written);
  ASSERT_EQ(back.frames.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_LE(
        mean_difference(back.frames[i].image, image::widen_channels(clip.images[i], back.info.channels)),
        c.tolerance);
}

INSTANTIATE_TEST_SUITE_P(Encoders, PixelFormats,
                         testing::Values(Kept{"a.mp4", "h264", "yuv420p", "yuv420p", 64, 48, 4},
                                         Kept{"a.mp4", "h264", "yuv420p10le", "yuv420p10le", 64, 48, 4},
                                         Kept{"a.mp4", "h264", "yuv444p", "yuv444p", 64, 48, 3},
                                         Kept{"a.mp4", "h264", "yuvj420p", "yuv420p", 64, 48, 4},
                                         Kept{"a.mp4", "h264", "gray", "yuv420p", 64, 48, 3},
                                         Kept{"odd.mp4", "h264", "yuv420p", "yuv444p", 65, 47, 3},
                                         Kept{"one.mp4", "h264", "yuv420p", "yuv444p", 1, 1, 6},
                                         Kept{"a.mkv", "hevc", "yuv420p10le", "yuv420p10le", 64, 48, 4},
                                         Kept{"odd.webm", "", "yuv420p", "yuv420p", 65, 47, 5},
                                         Kept{"alpha.webm", "vp9", "yuva420p", "yuva420p", 64, 48, 5},
                                         Kept{"odd.mkv", "ffv1", "yuv420p", "yuv420p", 65, 47, 3},
                                         Kept{"deep.mkv", "ffv1", "yuv444p10le", "yuv444p10le", 65, 47, 0.3},
                                         Kept{"odd.y4m", "", "yuv420p", "yuv420p", 65, 47, 4},
                                         Kept{"deep.y4m", "", "yuv422p10le", "yuv422p10le", 64, 48, 2},
                                         Kept{"odd.avi", "", "yuv420p", "yuv420p", 65, 47, 5},
                                         Kept{"odd.mov", "prores", "yuv420p", "yuv444p12le", 65, 47, 3},
                                         Kept{"a.mov", "prores", "yuv422p10le", "yuv422p10le", 64, 48, 3},
                                         Kept{"a.mov", "hap", "yuv420p", "rgb0", 64, 48, 6},
                                         Kept{"alpha.mov", "hap", "yuva420p", "rgba", 64, 48, 6},
                                         Kept{"a.gif", "", "rgb24", "bgr0", 64, 48, 5},
                                         Kept{"a.mkv", "av1", "yuv420p", "yuv420p", 64, 48, 6}));

TEST(RoundTrip, TagsAspectAndRotationSurvive) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(64, 48, 3, 2);
  clip.info.colour = {1, 9, 9, 16, 3};
  clip.info.sample_aspect = {4, 3};
  const std::int32_t matrix[9] = {0, 65536, 0, -65536, 0, 0, 0, 0, 1 << 30};
  clip.info.display_matrix.resize(sizeof matrix);
  std::copy_n(reinterpret_cast<const std::byte*>(matrix), sizeof matrix, clip.info.display_matrix.begin());
  for (const char* name : {"a.mp4", "a.mov", "a.mkv"}) {
    write_clip(dir / name, clip, with_codec("h264"));
    const StreamInfo back = read_clip(dir / name).info;
    EXPECT_EQ(back.colour, clip.info.colour) << name;
    const bool rotates = std::string(name) != "a.mkv";  // its pictures are turned
    EXPECT_EQ(back.sample_aspect, rotates ? clip.info.sample_aspect : (Rational{3, 4})) << name;
    EXPECT_EQ(back.display_matrix.empty(), !rotates) << name;
    EXPECT_TRUE(!rotates || back.display_matrix == clip.info.display_matrix) << name;
    EXPECT_NEAR(rotation_degrees(back), rotates ? 90 : 0, 1e-3) << name;
  }
}

TEST(RoundTrip, AspectOfOtherSizesShowsTheSamePicture) {
  StreamInfo info;
  info.width = 64;
  info.height = 48;
  EXPECT_FALSE(sample_aspect_at(info, 128, 48).known());
  info.sample_aspect = {2, 1};
  EXPECT_EQ(sample_aspect_at(info, 128, 48), (Rational{1, 1}));
  EXPECT_EQ(sample_aspect_at(info, 64, 96), (Rational{4, 1}));
  EXPECT_EQ(sample_aspect_at(info, 128, 96), (Rational{2, 1}));
  EXPECT_EQ(sample_aspect_at(info, 129, 97), (Rational{2, 1})) << "but for rounding";
  info.sample_aspect = {1, 1};
  EXPECT_EQ(sample_aspect_at(info, 100, 100), (Rational{1, 1})) << "square pixels stay square";
}

TEST(RoundTrip, RotationThatIsLostIsTold) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(16, 16, 3, 1);
  clip.info.display_matrix.resize(36);
  EXPECT_EQ(VideoWriter::create(dir / "a.mkv", clip.info).warnings().size(), 1u);
}

/// A matrix that shows a picture turned clockwise by so many quarters, and mirrored before that.
std::vector<std::byte> display_matrix(int quarters, bool mirrored) {
  constexpr int kCos[4] = {1, 0, -1, 0};
  const int c = kCos[quarters], s = kCos[(quarters + 3) % 4];
  const int side = mirrored ? -1 : 1;
  const std::int32_t matrix[9] = {side * c * 65536, side * s * 65536, 0, -s * 65536, c * 65536, 0, 0, 0,
                                  1 << 30};
  std::vector<std::byte> bytes(sizeof matrix);
  std::memcpy(bytes.data(), matrix, sizeof matrix);
  return bytes;
}

/// One quarter, pixel by pixel: what was at the left is at the top.
image::Image turned_once(const image::Image& image) {
  image::Image result = image::make_image(image.height, image.width, image.channels);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < image.channels; ++c) result.at(image.height - 1 - y, x, c) = image.at(x, y, c);
    }
  }
  return result;
}

image::Image mirrored(const image::Image& image) {
  image::Image result = image;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < image.channels; ++c) result.at(x, y, c) = image.at(image.width - 1 - x, y, c);
    }
  }
  return result;
}

TEST(RoundTrip, PicturesAreTurnedWherePlayersWouldNot) {
  const TempDir dir;
  for (const bool mirror : {false, true}) {
    for (int quarters = 0; quarters < 4; ++quarters) {
      ClipSpec clip = moving_pattern(37, 23, 3, 2);
      clip.info.pixel_format = "gbrp";
      clip.info.sample_aspect = {4, 3};
      clip.info.display_matrix = display_matrix(quarters, mirror);
      image::Image shown = mirror ? mirrored(clip.images[1]) : clip.images[1];
      for (int q = 0; q < quarters; ++q) shown = turned_once(shown);
      EXPECT_LE(largest_difference(turned(clip.images[1], turn_of(clip.info)), shown), 0);
      write_clip(dir / "a.mkv", clip, with_codec("ffv1"));
      write_clip(dir / "p%02d.png", clip);
      const WholeClip back = read_clip(dir / "a.mkv");
      EXPECT_LE(largest_difference(back.frames.at(1).image, shown), 1e-3) << quarters << mirror;
      EXPECT_EQ(back.info.sample_aspect, quarters % 2 == 0 ? (Rational{4, 3}) : (Rational{3, 4}));
      EXPECT_LE(largest_difference(image::read_image(dir / "p02.png"), shown), 1e-3) << quarters << mirror;
      // And players do in QuickTime.
      write_clip(dir / "a.mov", clip, with_codec("prores"));
      EXPECT_EQ(read_clip(dir / "a.mov").info.width, 37);
      EXPECT_EQ(read_clip(dir / "a.mov").info.display_matrix.empty(), quarters == 0 && !mirror);
    }
  }
}

TEST(RoundTrip, WhatIsUntaggedStaysUntagged) {
  const TempDir dir;
  const ClipSpec clip = moving_pattern(64, 48, 3, 2);
  for (const char* name : {"a.mp4", "a.mkv", "a.webm"}) {
    write_clip(dir / name, clip);
    const ColourTags tags = read_clip(dir / name).info.colour;
    EXPECT_EQ(tags.matrix, 2) << name;
    EXPECT_EQ(tags.primaries, 2) << name;
    EXPECT_EQ(tags.transfer, 2) << name;
  }
}

/// Flat fields, which survive any encoder, in colours that a wrong matrix or range shifts by many levels.
ClipSpec fields(int width, int height, const ColourTags& tags) {
  ClipSpec clip = moving_pattern(width, height, 3, 12);
  clip.info.colour = tags;
  clip.info.pixel_format = tags.range == 2 ? "yuvj420p" : "yuv420p";
  constexpr float kFields[4][3] = {{200, 40, 40}, {30, 180, 60}, {50, 60, 210}, {250, 250, 250}};
  for (int i = 0; i < 12; ++i) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        for (int c = 0; c < 3; ++c)
          clip.images[static_cast<std::size_t>(i)].at(x, y, c) = kFields[(4 * x / width + i / 3) % 4][c];
      }
    }
  }
  return clip;
}

class ColoursIn : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(ColoursIn, AreThoseOfTheSourceWhateverItsTags) {
  const TempDir dir;
  const auto [name, codec] = GetParam();
  for (const int height : {96, 720}) {
    for (const ColourTags tags : {ColourTags{}, ColourTags{1, 1}, ColourTags{2, 1}, ColourTags{2, 6}}) {
      const ClipSpec clip = fields(128, height, tags);
      write_clip(dir / name, clip, with_codec(codec));
      const WholeClip back = read_clip(dir / name);
      ASSERT_FALSE(back.frames.empty());  // some encoders leave repeated frames out
      EXPECT_LE(mean_difference(back.frames.back().image, clip.images.back()), 3)
          << height << " rows, range " << tags.range << ", matrix " << tags.matrix;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    Files, ColoursIn,
    testing::Values(std::pair("a.mp4", "h264"), std::pair("a.ts", "h264"), std::pair("a.flv", "h264"),
                    std::pair("a.webm", "vp9"), std::pair("a.webm", "vp8"), std::pair("a.mkv", "av1"),
                    std::pair("a.mkv", "ffv1"), std::pair("a.nut", "ffv1"), std::pair("a.avi", "ffv1"),
                    std::pair("a.mov", "prores"), std::pair("a.avi", ""), std::pair("a.mp4", "mpeg4"),
                    std::pair("a.mkv", "mpeg4"), std::pair("a.mpg", ""), std::pair("a.vob", ""),
                    std::pair("a.wmv", ""), std::pair("a.ogv", ""), std::pair("a.avi", "mjpeg"),
                    std::pair("a.mov", "mjpeg"), std::pair("a.mjpeg", ""), std::pair("a.flv", "flv")));

TEST(RoundTrip, FullRangeKeepsBlackAndWhite) {
  const TempDir dir;
  for (const int range : {1, 2}) {
    ClipSpec clip = moving_pattern(32, 32, 3, 1);
    clip.info.colour.range = range;
    for (std::size_t i = 0; i < clip.images[0].samples.size(); ++i)
      clip.images[0].samples[i] = i < 1536 ? 0 : 255;
    write_clip(dir / "a.mkv", clip, with_codec("ffv1", "yuv444p"));
    const WholeClip back = read_clip(dir / "a.mkv");
    EXPECT_EQ(back.info.colour.range, range);
    EXPECT_LE(largest_difference(back.frames.at(0).image, clip.images[0]), 1e-3);
  }
}

}  // namespace
}  // namespace knotreel::video
