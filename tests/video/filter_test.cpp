// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "clips.h"
#include "support/pictures.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::largest_difference;
using test::TempDir;
using test::write_text;

constexpr int kWidth = 64, kHeight = 48;

/// How bright a scene is at x at a moment; two moments for each frame.
using Scene = std::function<int(int x, int moment)>;

/// A bar that moves by four pixels from moment to moment, on a ramp.
int moving_bar(int x, int moment) {
  const int from = 4 + 4 * moment;
  return x >= from && x < from + 12 ? 220 : 40 + x;
}

/// YUV4MPEG2 says of itself how its lines are interlaced: 't' top lines first, 'b', or 'p' not at all. Odd
/// lines are of the other moment unless it is 'p'.
void write_lines(const std::string& path, char order, int frames, const Scene& scene) {
  std::string bytes = "YUV4MPEG2 W64 H48 F25:1 I" + std::string(1, order) + " A1:1 C444\n";
  for (int i = 0; i < frames; ++i) {
    bytes += "FRAME\n";
    for (int y = 0; y < kHeight; ++y) {
      const bool second = order == 't' ? y % 2 == 1 : order == 'b' ? y % 2 == 0 : false;
      for (int x = 0; x < kWidth; ++x) bytes += char(scene(x, 2 * i + (second ? 1 : 0)));
    }
    bytes += std::string(2 * kWidth * kHeight, char(128));
  }
  write_text(path, bytes);
}

/// By how much lines differ from those above and below, which are alike in these scenes: a comb.
double comb(const image::Image& image) {
  double sum = 0;
  for (int y = 1; y + 1 < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      sum += std::abs(image.at(x, y, 0) - (image.at(x, y - 1, 0) + image.at(x, y + 1, 0)) / 2);
    }
  }
  return sum / double(image.width * (image.height - 2));
}

ReadOptions deinterlaced(Deinterlace mode) {
  ReadOptions options;
  options.deinterlace = mode;
  return options;
}

ReadOptions filtered(const std::string& filter) {
  ReadOptions options;
  options.filter = filter;
  return options;
}

/// A frame of the scene as it is at a moment.
WholeClip whole_moments(const TempDir& dir, const std::function<int(int)>& moment_of, int frames) {
  write_lines(dir / "whole.y4m", 'p', frames,
              [&](int x, int moment) { return moving_bar(x, moment_of(moment / 2)); });
  return read_clip(dir / "whole.y4m");
}

TEST(Deinterlace, MarkedFramesShowTheirFirstMoment) {
  const TempDir dir;
  const WholeClip whole = whole_moments(
      dir, [](int i) { return 2 * i; }, 6);
  for (const char order : {'t', 'b'}) {
    write_lines(dir / "a.y4m", order, 6, moving_bar);
    const WholeClip clip = read_clip(dir / "a.y4m");
    EXPECT_EQ(clip.info.fields, order == 't' ? Fields::kTopFirst : Fields::kBottomFirst);
    EXPECT_EQ(clip.info.frame_rate, (Rational{25, 1}));
    ASSERT_EQ(clip.frames.size(), 6U);
    for (std::size_t i = 0; i < 6; ++i) {
      EXPECT_EQ(clip.frames[i].pts, whole.frames[i].pts);
      EXPECT_EQ(clip.frames[i].duration, whole.frames[i].duration);
      EXPECT_LT(comb(clip.frames[i].image), 0.5) << order << i;
      EXPECT_LT(mean_difference(clip.frames[i].image, whole.frames[i].image), 0.5) << order << i;
    }
    ASSERT_EQ(clip.warnings.size(), 1U);
    EXPECT_EQ(clip.warnings[0], "6 frames are interlaced, and deinterlaced");
  }
}

TEST(Deinterlace, NotIfItIsNotWanted) {
  const TempDir dir;
  write_lines(dir / "a.y4m", 't', 3, moving_bar);
  const WholeClip clip = read_clip(dir / "a.y4m", deinterlaced(Deinterlace::kNone));
  ASSERT_EQ(clip.frames.size(), 3U);
  for (const Frame& frame : clip.frames) EXPECT_GT(comb(frame.image), 10);
  EXPECT_TRUE(clip.warnings.empty());
}

TEST(Deinterlace, FieldsAreFramesOfTwiceTheRate) {
  const TempDir dir;
  const WholeClip whole = whole_moments(
      dir, [](int i) { return i; }, 10);
  write_lines(dir / "a.y4m", 't', 5, moving_bar);
  const WholeClip clip = read_clip(dir / "a.y4m", deinterlaced(Deinterlace::kFields));
  EXPECT_EQ(clip.info.frame_rate, (Rational{50, 1}));
  ASSERT_EQ(clip.frames.size(), 10U);
  const std::vector<double> times = seconds(clip);
  for (std::size_t i = 0; i < 10; ++i) {
    EXPECT_DOUBLE_EQ(times[i], double(i) / 50);
    EXPECT_DOUBLE_EQ(double(clip.frames[i].duration) * clip.info.time_base.value(), 0.02);
    EXPECT_LT(mean_difference(clip.frames[i].image, whole.frames[i].image), 0.5) << i;
  }
}

TEST(Deinterlace, FieldsAreOfAllFramesSoTheRateHolds) {
  const TempDir dir;
  write_lines(dir / "a.y4m", 'p', 5, moving_bar);
  const WholeClip clip = read_clip(dir / "a.y4m", deinterlaced(Deinterlace::kFields));
  EXPECT_EQ(clip.info.frame_rate, (Rational{50, 1}));
  ASSERT_EQ(clip.frames.size(), 10U);
  const std::vector<double> times = seconds(clip);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_DOUBLE_EQ(times[i], double(i) / 50);
}

TEST(Deinterlace, WhatRestsKeepsAllLines) {
  const TempDir dir;
  write_lines(dir / "a.y4m", 't', 4, [](int x, int) { return (x * 37) % 200 + 20; });
  const WholeClip as_it_is = read_clip(dir / "a.y4m", deinterlaced(Deinterlace::kNone));
  const WholeClip clip = read_clip(dir / "a.y4m");
  ASSERT_EQ(clip.frames.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_EQ(largest_difference(clip.frames[i].image, as_it_is.frames[i].image), 0);
}

TEST(Deinterlace, UnmarkedFramesAreLeftAloneUnlessAllAreMeant) {
  const TempDir dir;
  // Interlaced in truth; the file says nothing of it.
  write_lines(dir / "t.y4m", 't', 4, moving_bar);
  std::string bytes = test::read_text(dir / "t.y4m");
  bytes.replace(bytes.find("It"), 2, "Ip");
  write_text(dir / "a.y4m", bytes);
  const WholeClip left = read_clip(dir / "a.y4m");
  EXPECT_EQ(left.info.fields, Fields::kNone);
  EXPECT_TRUE(left.warnings.empty());
  for (const Frame& frame : left.frames) EXPECT_GT(comb(frame.image), 10);
  for (const Frame& frame : read_clip(dir / "a.y4m", deinterlaced(Deinterlace::kAll)).frames)
    EXPECT_LT(comb(frame.image), 0.5);
}

TEST(Deinterlace, TooSmallFramesAreLeftAsTheyAre) {
  const TempDir dir;
  write_text(dir / "a.y4m", "YUV4MPEG2 W2 H2 F25:1 It A1:1 C444\nFRAME\n" + std::string(12, 'x'));
  const WholeClip clip = read_clip(dir / "a.y4m");
  EXPECT_EQ(clip.frames.size(), 1U);
  ASSERT_EQ(clip.warnings.size(), 1U);
  EXPECT_TRUE(clip.warnings[0].starts_with("interlaced frames are left as they are: "));
}

TEST(Filter, CropsScalesAndCountsTimes) {
  const TempDir dir;
  write_clip(dir / "a.mkv", moving_pattern(64, 48, 3, 10), with_codec("ffv1", "bgr0"));
  const WholeClip all = read_clip(dir / "a.mkv");
  const WholeClip part = read_clip(dir / "a.mkv", filtered("crop=20:10:8:6,framestep=5"));
  EXPECT_EQ(part.info.width, 20);
  EXPECT_EQ(part.info.height, 10);
  EXPECT_EQ(part.info.frame_rate, (Rational{5, 1}));
  ASSERT_EQ(part.frames.size(), 2U);
  EXPECT_EQ(seconds(part), (std::vector<double>{0, 0.2}));
  EXPECT_DOUBLE_EQ(double(part.frames[1].duration) * part.info.time_base.value(), 0.2);
  EXPECT_EQ(part.frames[0].image.at(3, 2, 1), all.frames[0].image.at(11, 8, 1));
  EXPECT_TRUE(part.warnings.empty());
}

/// In a codec that does not tell it of itself.
void write_anamorphic(const std::string& path) {
  ClipSpec clip = moving_pattern(64, 48, 3, 4);
  clip.info.sample_aspect = {2, 1};
  write_clip(path, clip, with_codec("huffyuv", "rgb24"));
}

TEST(Filter, KeepsTheShapeOfPixelsThatOnlyTheContainerTells) {
  const TempDir dir;
  write_anamorphic(dir / "a.mkv");
  EXPECT_EQ(read_clip(dir / "a.mkv").info.sample_aspect, (Rational{2, 1}));
  EXPECT_EQ(read_clip(dir / "a.mkv", filtered("null")).info.sample_aspect, (Rational{2, 1}));
  EXPECT_EQ(read_clip(dir / "a.mkv", filtered("scale=128:48")).info.sample_aspect, (Rational{1, 1}));
  EXPECT_EQ(read_clip(dir / "a.mkv", deinterlaced(Deinterlace::kFields)).info.sample_aspect,
            (Rational{2, 1}));
}

image::Image plain(int width, int height) {
  image::Image image = image::make_image(width, height, 3);
  constexpr float kRed[] = {220, 40, 40};
  for (std::size_t i = 0; i < image.samples.size(); ++i) image.samples[i] = kRed[i % 3];
  return image;
}

/// What is not told follows from the size, of the stream and not of what a filter leaves.
TEST(Filter, DoesNotChangeColours) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(960, 720, 3, 1);
  clip.images[0] = plain(960, 720);
  write_clip(dir / "high.mkv", clip, with_codec("ffv1", "yuv444p"));
  EXPECT_LT(
      largest_difference(read_clip(dir / "high.mkv", filtered("crop=64:48")).frames[0].image, plain(64, 48)),
      2);
  clip = moving_pattern(64, 48, 3, 1);
  clip.images[0] = plain(64, 48);
  write_clip(dir / "low.mkv", clip, with_codec("ffv1", "yuv444p"));
  EXPECT_LT(largest_difference(read_clip(dir / "low.mkv", filtered("scale=960:720")).frames[0].image,
                               plain(960, 720)),
            2);
}

TEST(Filter, PartsAreOfTheFilteredFrames) {
  const TempDir dir;
  write_clip(dir / "a.mkv", moving_pattern(64, 48, 3, 10), with_codec("ffv1", "bgr0"));
  ReadOptions options = filtered("setpts=2*PTS,hflip");
  options.part.start = 0.24;
  const WholeClip clip = read_clip(dir / "a.mkv", options);
  const WholeClip all = read_clip(dir / "a.mkv");
  ASSERT_EQ(clip.frames.size(), 7U);  // at 0.24, 0.32, ..., 0.72
  EXPECT_EQ(clip.frames[0].image.at(0, 5, 0), all.frames[3].image.at(63, 5, 0));
}

TEST(Filter, TimesGoUpWhateverAFilterDoes) {
  const TempDir dir;
  write_clip(dir / "a.mkv", moving_pattern(32, 24, 3, 5), with_codec("ffv1", "bgr0"));
  const WholeClip clip = read_clip(dir / "a.mkv", filtered("setpts=0"));
  ASSERT_EQ(clip.frames.size(), 5U);
  for (std::size_t i = 1; i < 5; ++i) EXPECT_GT(clip.frames[i].pts, clip.frames[i - 1].pts);
  ASSERT_EQ(clip.warnings.size(), 1U);
  EXPECT_TRUE(clip.warnings[0].starts_with("4 frames go back in time")) << clip.warnings[0];
}

TEST(Filter, FramesOfAnotherSizeAreFilteredToo) {
  const TempDir dir;
  write_clip(dir / "a.ts", moving_pattern(64, 48, 3, 6), with_codec("mpeg2video", "yuv420p"));
  write_clip(dir / "b.ts", moving_pattern(96, 80, 3, 6), with_codec("mpeg2video", "yuv420p"));
  write_text(dir / "both.ts", test::read_text(dir / "a.ts") + test::read_text(dir / "b.ts"));
  const WholeClip clip = read_clip(dir / "both.ts", filtered("scale=32:24"));
  EXPECT_EQ(clip.frames.size(), read_clip(dir / "both.ts").frames.size());
  for (const Frame& frame : clip.frames) EXPECT_EQ(frame.image.width, 32);
}

TEST(Filter, WhatIsNoFilterIsToldByName) {
  const TempDir dir;
  write_clip(dir / "a.mkv", moving_pattern(32, 24, 3, 2), with_codec("ffv1", "bgr0"));
  for (const std::string wrong : {"foo", "crop=900:900", "split[a][b]", "[", "crop=1:2:3:4:5:6:7:8"}) {
    SCOPED_TRACE(wrong);
    EXPECT_EQ(kind_of([&] { read_clip(dir / "a.mkv", filtered(wrong)); }), ErrorKind::kInvalidArgument);
  }
  try {
    read_clip(dir / "a.mkv", filtered("foo"));
    FAIL();
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(), "cannot filter with 'foo': No such filter: 'foo'");
  }
}

TEST(Filter, NothingLeftIsAnError) {
  const TempDir dir;
  write_clip(dir / "a.mkv", moving_pattern(32, 24, 3, 2), with_codec("ffv1", "bgr0"));
  EXPECT_EQ(kind_of([&] { read_clip(dir / "a.mkv", filtered("select=0")); }), ErrorKind::kInvalidArgument);
}

TEST(Filter, PicturesHaveNone) {
  const TempDir dir;
  write_clip(dir / "f_%d.png", moving_pattern(32, 24, 3, 2));
  EXPECT_EQ(kind_of([&] { read_clip(dir / "f_%d.png", filtered("hflip")); }), ErrorKind::kInvalidArgument);
}

/// As that of ffmpeg does.
TEST(Filter, RatesGoOnToTheEndOfTheLastFrame) {
  const TempDir dir;
  write_clip(dir / "a.mkv", moving_pattern(64, 48, 3, 10), with_codec("ffv1"));
  for (const auto& [rate, frames] : {std::pair(50, 20u), std::pair(75, 30u), std::pair(5, 2u)}) {
    const WholeClip clip = read_clip(dir / "a.mkv", filtered("fps=" + std::to_string(rate)));
    ASSERT_EQ(clip.frames.size(), frames) << rate;
    EXPECT_NEAR(seconds(clip).back(), 0.4 - 1.0 / rate, 1e-9) << rate;
  }
}

}  // namespace
}  // namespace knotreel::video
