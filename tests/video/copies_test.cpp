// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "clips.h"
#include "support/libav_clips.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::TempDir;

bool same_bytes(const Packet& a, const Packet& b) {
  return a.bytes().size() == b.bytes().size() &&
         std::memcmp(a.bytes().data(), b.bytes().data(), a.bytes().size()) == 0;
}

struct Copy {
  const char* from;
  const char* codec;
  const char* to;
  double slack;  ///< of times, in seconds: what the containers round
};

std::ostream& operator<<(std::ostream& out, const Copy& c) {
  return out << c.from << ", " << c.codec << ", " << c.to;
}

class Copied : public testing::TestWithParam<Copy> {};

TEST_P(Copied, SoundIsTheSameAndInTime) {
  const Copy& c = GetParam();
  const TempDir dir;
  write_sound_clip(dir / c.from, c.codec, true);
  EXPECT_TRUE(copy_clip(dir / c.from, dir / c.to).empty());
  const WholeClip source = read_clip(dir / c.from), copy = read_clip(dir / c.to);
  EXPECT_EQ(copy.frames.size(), 25u);
  ASSERT_GT(source.packets.size(), 10u);
  ASSERT_EQ(copy.packets.size(), source.packets.size());
  // Matroska has no times before zero: everything moves together.
  const double shift = seconds(copy).at(0) - seconds(source).at(0);
  for (std::size_t i = 0; i < copy.packets.size(); ++i) {
    EXPECT_TRUE(same_bytes(copy.packets[i], source.packets[i])) << i;
    EXPECT_NEAR(copy.packets[i].seconds() - shift, source.packets[i].seconds(), c.slack) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Containers, Copied,
    testing::Values(Copy{"a.mp4", "aac", "b.mp4", 1e-9}, Copy{"a.mp4", "aac", "b.mov", 1e-9},
                    Copy{"a.mp4", "aac", "b.mkv", 0.0011}, Copy{"a.mkv", "aac", "b.mp4", 0.0011},
                    Copy{"a.mov", "pcm_s16le", "b.mov", 1e-9}, Copy{"a.mov", "pcm_s16le", "b.mkv", 0.0011},
                    // What cameras and old programs write; Matroska has no names of its own for these.
                    Copy{"a.mov", "pcm_alaw", "b.mkv", 0.0011}, Copy{"a.avi", "pcm_mulaw", "b.mkv", 0.0011},
                    Copy{"a.wmv", "wmav2", "b.mkv", 0.0021},
                    // Matroska has its times of Opus late by what decoders leave out at the start.
                    Copy{"a.mp4", "libopus", "b.mkv", 0.0011}, Copy{"a.mkv", "libopus", "b.webm", 0.0011},
                    Copy{"a.mkv", "libopus", "b.mp4", 0.0011}));

/// Where sound begins has nothing to do with frames.
TEST(Copies, BeginWhereTheyDidBesideFramesOfACoarseClock) {
  const TempDir dir;
  write_sound_clip(dir / "a.mp4", "aac", true);
  ReadOptions options;
  options.filter = "fps=10";
  options.part.first = 3;
  copy_clip(dir / "a.mp4", dir / "b.mp4", options);
  const WholeClip source = read_clip(dir / "a.mp4", options), copy = read_clip(dir / "b.mp4");
  ASSERT_FALSE(source.packets.empty());
  ASSERT_EQ(copy.packets.size(), source.packets.size());
  EXPECT_EQ(copy.info.time_base.den, 10);
  const double delay = source.packets[0].seconds() - seconds(source).at(0);
  EXPECT_NEAR(copy.packets[0].seconds() - seconds(copy).at(0), delay, 1e-4);
}

TEST(Copies, WhatTheContainerDoesNotTakeIsLeftOutAndTold) {
  const TempDir dir;
  write_sound_clip(dir / "a.mp4", "aac", true);
  for (const char* name : {"b.webm", "b.y4m"}) {
    const std::vector<std::string> warnings = copy_clip(dir / "a.mp4", dir / name);
    ASSERT_EQ(warnings.size(), 1u) << name;
    EXPECT_NE(warnings[0].find("aac"), std::string::npos);
    const WholeClip copy = read_clip(dir / name);
    EXPECT_EQ(copy.frames.size(), 25u);
    EXPECT_TRUE(copy.packets.empty());
  }
}

/// One track of sound each, which the container says of all together.
TEST(Copies, WhatTheContainerDoesNotTakeBesideAnotherIsLeftOut) {
  const TempDir dir;
  write_clip_with_two_sounds(dir / "two.mkv");
  const std::vector<std::string> warnings = copy_clip(dir / "two.mkv", dir / "b.flv");
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_EQ(warnings[0], "stream 2 (audio, aac) is left out: container 'flv' does not take it");
  EXPECT_FALSE(read_clip(dir / "b.flv").packets.empty());
  EXPECT_TRUE(copy_clip(dir / "two.mkv", dir / "b.mkv").empty());
}

TEST(Copies, AreNotAmongTheBytesOfRawPictures) {
  const TempDir dir;
  write_sound_clip(dir / "a.mp4", "aac", true);
  EXPECT_EQ(copy_clip(dir / "a.mp4", dir / "b.yuv").size(), 1u);
  ReadOptions silent;
  silent.copy_streams = false;
  EXPECT_TRUE(copy_clip(dir / "a.mp4", dir / "silent.yuv", silent).empty());
  EXPECT_EQ(std::filesystem::file_size(dir / "b.yuv"), std::filesystem::file_size(dir / "silent.yuv"));
}

/// "video mpeg4, audio aac", ...
std::string streams_of(const std::string& path) {
  std::string text;
  for (const StreamEntry& stream : VideoReader::open(path).streams())
    text += (text.empty() ? "" : ", ") + stream.kind + " " + stream.codec;
  return text;
}

std::size_t text_packets(const std::string& path) {
  std::size_t count = 0;
  for (const Packet& packet : read_clip(path).packets) {
    count += std::string(reinterpret_cast<const char*>(packet.bytes().data()), packet.bytes().size())
                 .starts_with("Zeile ");
  }
  return count;
}

TEST(Copies, TextsAndFontsGoAlong) {
  const TempDir dir;
  write_titled_clip(dir / "a.mkv");
  EXPECT_TRUE(copy_clip(dir / "a.mkv", dir / "b.mkv").empty());
  EXPECT_EQ(streams_of(dir / "b.mkv"), "video h264, audio aac, subtitle subrip, attachment ttf");
  EXPECT_EQ(text_packets(dir / "b.mkv"), 3u);
  EXPECT_EQ(text_packets(dir / "a.mkv"), 3u);
  EXPECT_NE(test::read_text(dir / "a.mkv").find("12345"), std::string::npos);
  for (const char* stale : {"12345", "_STATISTICS"})
    EXPECT_EQ(test::read_text(dir / "b.mkv").find(stale), std::string::npos) << stale;
}

TEST(Copies, PausesBetweenTextsOfMp4StayAsManyAsTheyAre) {
  const TempDir dir;
  write_clip_with_mp4_texts(dir / "a.mp4");
  EXPECT_TRUE(copy_clip(dir / "a.mp4", dir / "b.mp4").empty());
  const WholeClip source = read_clip(dir / "a.mp4"), copy = read_clip(dir / "b.mp4");
  ASSERT_GE(source.packets.size(), 5u);
  ASSERT_EQ(copy.packets.size(), source.packets.size());
  for (std::size_t i = 0; i < copy.packets.size(); ++i) {
    EXPECT_TRUE(same_bytes(copy.packets[i], source.packets[i])) << i;
    EXPECT_NEAR(copy.packets[i].seconds(), source.packets[i].seconds(), 1e-3) << i;
  }
}

TEST(Copies, WhatTransportStreamsHaveNoTypeForIsLeftOut) {
  const TempDir dir;
  write_titled_clip(dir / "a.mkv");
  const std::vector<std::string> warnings = copy_clip(dir / "a.mkv", dir / "b.ts");
  ASSERT_EQ(warnings.size(), 2u);
  EXPECT_NE(warnings[0].find("subrip"), std::string::npos);
  EXPECT_NE(warnings[1].find("ttf"), std::string::npos);
  EXPECT_EQ(streams_of(dir / "b.ts"), "video h264, audio aac");
}

/// They take any text for the pictures of DVDs.
TEST(Copies, TextsAreLeftOutOfProgramStreams) {
  const TempDir dir;
  write_titled_clip(dir / "a.mkv");
  const std::vector<std::string> warnings = copy_clip(dir / "a.mkv", dir / "b.mpg");
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(), [](const std::string& line) {
    return line == "stream 2 (subtitle, subrip) is left out: container 'mpeg' does not take it";
  }));
  EXPECT_EQ(streams_of(dir / "b.mpg").find("subtitle"), std::string::npos);
}

/// AVI has no times but by a rate, which packets of these do not have.
TEST(Copies, SoundThatAviHasNoTimesForIsLeftOut) {
  for (const char* codec : {"flac", "libvorbis"}) {
    const TempDir dir;
    write_sound_clip(dir / "a.mkv", codec, true);
    EXPECT_EQ(copy_clip(dir / "a.mkv", dir / "b.avi").size(), 1u) << codec;
    EXPECT_TRUE(read_clip(dir / "b.avi").packets.empty()) << codec;
  }
}

TEST(Copies, AreNotReadIfNotWanted) {
  const TempDir dir;
  write_sound_clip(dir / "a.mp4", "aac", true);
  ReadOptions options;
  options.copy_streams = false;
  EXPECT_TRUE(read_clip(dir / "a.mp4", options).packets.empty());
}

TEST(Copies, TravelWithTheFrames) {
  const TempDir dir;
  write_sound_clip(dir / "a.mp4", "aac", true);
  std::size_t most = 0;
  for (const Frame& frame : read_clip(dir / "a.mp4").frames) most = std::max(most, frame.packets.size());
  EXPECT_LT(most, 40u);
}

TEST(Copies, AreReadWithoutThePicturesToo) {
  const TempDir dir;
  write_sound_clip(dir / "a.mp4", "aac", true);
  const WholeClip clip = read_clip(dir / "a.mp4");
  VideoReader reader = VideoReader::open(dir / "a.mp4");
  std::vector<Packet> packets = reader.packets_until(0.2);
  EXPECT_GT(packets.size(), 5u);
  EXPECT_LT(packets.size(), clip.packets.size() / 2);
  for (const double until : {0.2, 0.5, std::numeric_limits<double>::infinity()}) {
    for (const Packet& packet : reader.packets_until(until)) packets.push_back(packet);
  }
  ASSERT_EQ(packets.size(), clip.packets.size());
  for (std::size_t i = 0; i < packets.size(); ++i) {
    EXPECT_TRUE(same_bytes(packets[i], clip.packets[i])) << i;
    EXPECT_EQ(packets[i].seconds(), clip.packets[i].seconds()) << i;
  }
}

TEST(Copies, WithoutThePicturesTellIfTheFileEndsEarlyToo) {
  const TempDir dir;
  write_sound_clip(dir / "a.mkv", "aac", true);
  const auto warnings = [&](const std::string& name) {
    VideoReader reader = VideoReader::open(dir / name);
    EXPECT_GT(reader.packets_until(std::numeric_limits<double>::infinity()).size(), 5u);
    EXPECT_TRUE(reader.packets_until(std::numeric_limits<double>::infinity()).empty());
    return reader.warnings();
  };
  EXPECT_TRUE(warnings("a.mkv").empty());
  std::filesystem::copy_file(dir / "a.mkv", dir / "cut.mkv");
  std::filesystem::resize_file(dir / "cut.mkv", std::filesystem::file_size(dir / "a.mkv") / 2);
  const std::vector<std::string> lines = warnings("cut.mkv");
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("ends early"), std::string::npos) << lines[0];
}

TEST(Copies, MoveInTime) {
  const TempDir dir;
  write_sound_clip(dir / "a.mp4", "aac", true);
  const Packet packet = read_clip(dir / "a.mp4").packets.at(7);
  const Packet earlier = packet.earlier(3, {1, 25});
  EXPECT_TRUE(same_bytes(packet, earlier));
  EXPECT_NEAR(earlier.seconds(), packet.seconds() - 0.12, 1e-9);
  EXPECT_TRUE(std::isnan(Packet().earlier(3, {1, 25}).seconds()));
}

TEST(Copies, SoundAloneIsNoVideo) {
  const TempDir dir;
  write_sound_clip(dir / "a.mp4", "aac", false);
  const std::string path = dir / "a.mp4";
  try {
    VideoReader::open(path);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kInput);
    EXPECT_EQ(std::string(e.what()), "'" + path + "' has no video stream");
  }
}

}  // namespace
}  // namespace knotreel::video
