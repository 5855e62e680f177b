// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "clips.h"
#include "support/pictures.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::read_text;
using test::TempDir;

using Pairs = std::map<std::string, std::string>;

WriteOptions with_options(const std::string& codec, const Pairs& encoder, const Pairs& container = {}) {
  WriteOptions options = with_codec(codec);
  options.encoder_options = encoder;
  options.container_options = container;
  return options;
}

ClipSpec noise(int frames) {
  ClipSpec clip = moving_pattern(64, 48, 3, frames);
  for (std::size_t i = 0; i < clip.images.size(); ++i)
    clip.images[i] = test::random_8bit_picture(64, 48, 3, unsigned(i));
  return clip;
}

std::uintmax_t size_of(const WriteOptions& options) {
  const TempDir dir;
  write_clip(dir / "a.nut", noise(12), options);
  return std::filesystem::file_size(dir / "a.nut");
}

TEST(EncoderOptions, ARateTakesThePlaceOfTheDefaultQuality) {
  for (const char* codec : {"h264", "hevc", "vp9", "vp8", "mpeg4", "mpeg2video", "theora"})
    EXPECT_LT(size_of(with_options(codec, {{"b", "100k"}})), size_of(with_codec(codec))) << codec;
}

TEST(EncoderOptions, AreOverWhatIsChosen) {
  EXPECT_LT(2 * size_of(with_options("h264", {{"crf", "45"}})), size_of(with_codec("h264")));
  EXPECT_LT(2 * size_of(with_options("h264", {{"qp", "45"}})), size_of(with_codec("h264")));
  EXPECT_LT(2 * size_of(with_options("h264", {{"x264-params", "qp=45"}})), size_of(with_codec("h264")));
  EXPECT_LT(2 * size_of(with_options("hevc", {{"x265-params", "qp=45"}})), size_of(with_codec("hevc")));
  WriteOptions both = with_options("h264", {{"crf", "45"}});
  both.crf = 10;
  EXPECT_EQ(size_of(both), size_of(with_options("h264", {{"crf", "45"}})));
}

TEST(EncoderOptions, ColoursAreMadeWithTheMatrixThatIsAskedFor) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(64, 48, 3, 1);
  constexpr float kRed[] = {220, 40, 40};
  for (std::size_t i = 0; i < clip.images[0].samples.size(); ++i) clip.images[0].samples[i] = kRed[i % 3];
  WriteOptions options = with_codec("ffv1", "yuv444p");
  options.encoder_options = {{"colorspace", "bt709"}};
  write_clip(dir / "a.mkv", clip, options);
  const WholeClip back = read_clip(dir / "a.mkv");
  EXPECT_EQ(back.info.colour.matrix, 1);
  EXPECT_LT(test::largest_difference(back.frames[0].image, clip.images[0]), 2);
}

TEST(EncoderOptions, Vp8HasAlphaWithoutAny) {
  const TempDir dir;
  write_clip(dir / "a.webm", moving_pattern(64, 48, 4, 2), with_codec("vp8"));
  EXPECT_EQ(read_clip(dir / "a.webm").info.channels, 4);
}

TEST(EncoderOptions, WhatCannotBeIsRefused) {
  const TempDir dir;
  const StreamInfo info = moving_pattern(64, 48, 3, 1).info;
  const auto refused = [&](const std::string& name, const WriteOptions& options, const std::string& told) {
    try {
      VideoWriter::create(dir / name, info, options);
      ADD_FAILURE() << told;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kInvalidArgument) << e.what();
      EXPECT_NE(std::string(e.what()).find(told), std::string::npos) << e.what();
    }
    EXPECT_EQ(dir.entries(), 0u) << told;
  };
  refused("a.mp4", with_options("h264", {{"nonsense", "1"}}), "'libx264' has no option 'nonsense'");
  refused("a.mp4", with_options("h264", {{"nonsense", ""}}), "'libx264' has no option 'nonsense'");
  refused("a.mp4", with_options("h264", {{"b", "much"}}), "b=much");
  refused("a.mp4", with_options("h264", {{"crf", "99"}}), "takes a crf from 0 to 51, not 99");
  refused("a.mp4", with_options("h264", {{"tune", "film,nonsense"}}), "no tune is called 'nonsense'");
  refused("a.mp4", with_options("h264", {{"profile", "nonsense"}}), "no profile is called 'nonsense'");
  refused("a.mp4", with_options("h264", {{"preset", "nonsense"}}), "no preset is called 'nonsense'");
  refused("a.mp4", with_options("hevc", {{"tune", "nonsense"}}), "tune=nonsense");
  refused("a.mkv", with_options("ffv1", {{"preset", "slow"}}), "'ffv1' has no option 'preset'");
  refused("a.mp4", with_options("h264", {}, {{"nonsense", "1"}}), "'mp4' has no option 'nonsense'");
  refused("a.mp4", with_options("h264", {}, {{"movflags", "nonsense"}}), "nonsense");
}

TEST(EncoderOptions, QualityBeyondTheScaleIsRefused) {
  const TempDir dir;
  const StreamInfo info = moving_pattern(64, 48, 3, 1).info;
  const auto told = [&](const char* codec, double crf) -> std::string {
    WriteOptions options = with_codec(codec);
    options.crf = crf;
    try {
      VideoWriter::create(dir / "a.nut", info, options);
      return "";
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kInvalidArgument) << e.what();
      return e.what();
    }
  };
  const std::map<std::string, int> scales = {{"h264", 51},  {"libx264rgb", 51}, {"hevc", 51},
                                             {"vp9", 63},   {"vp8", 63},        {"av1", 63},
                                             {"mpeg4", 31}, {"mjpeg", 31},      {"theora", 10}};
  for (const auto& [codec, worst] : scales) {
    EXPECT_EQ(told(codec.c_str(), 0), "") << codec;
    EXPECT_EQ(told(codec.c_str(), worst), "") << codec;
    const std::string why = told(codec.c_str(), worst + 0.5);
    EXPECT_NE(why.find("takes a crf from 0 to " + std::to_string(worst) + ", not "), std::string::npos)
        << codec << ": " << why;
  }
  EXPECT_NE(told("libwebp", 101).find("from 0 to 100"), std::string::npos);
  EXPECT_NE(told("h264", std::nan("")), "");
  EXPECT_EQ(told("ffv1", 200), "");  // which has no scale, and tells that
}

TEST(EncoderOptions, WhatAnEncoderComplainsOfIsTold) {
  const TempDir dir;
  const StreamInfo info = moving_pattern(64, 48, 3, 1).info;
  const auto warnings = [&](const WriteOptions& options) {
    return VideoWriter::create(dir / "a.mp4", info, options).warnings();
  };
  EXPECT_EQ(warnings(with_options("h264", {{"x264-params", "keyint=5"}})).size(), 0u);
  ASSERT_EQ(warnings(with_options("h264", {{"x264-params", "nonsense=5"}})).size(), 1u);
  EXPECT_NE(warnings(with_options("h264", {{"x264-params", "nonsense=5"}}))[0].find("nonsense"),
            std::string::npos);
}

TEST(EncoderOptions, AreToldToBeOfNoUseWhereNothingIsEncoded) {
  const TempDir dir;
  const StreamInfo info = moving_pattern(64, 48, 3, 1).info;
  for (const WriteOptions& options : {with_options("", {{"b", "1M"}}), with_options("", {}, {{"a", "b"}})})
    EXPECT_EQ(VideoWriter::create(dir / "%d.png", info, options).warnings().size(), 1u);
}

TEST(ContainerOptions, TheIndexMayGoFirst) {
  const TempDir dir;
  const ClipSpec clip = noise(6);
  const auto index_is_first = [&](const Pairs& options) {
    write_clip(dir / "a.mp4", clip, with_options("h264", {}, options));
    EXPECT_EQ(read_clip(dir / "a.mp4").frames.size(), clip.images.size());
    const std::string bytes = read_text(dir / "a.mp4");
    return bytes.find("moov") < bytes.find("mdat");
  };
  EXPECT_FALSE(index_is_first({}));
  EXPECT_TRUE(index_is_first({{"movflags", "+faststart"}}));
  EXPECT_TRUE(index_is_first({{"movflags", "faststart"}}));
}

}  // namespace
}  // namespace knotreel::video
