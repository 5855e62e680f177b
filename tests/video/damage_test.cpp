// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "clips.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::read_text;
using test::TempDir;
using test::write_text;

TEST(Damage, WhatIsNoVideoIsAnInputError) {
  const TempDir dir;
  write_text(dir / "empty.mp4", "");
  write_text(dir / "text.txt", "This is a text, and not a video at all.\n");
  write_text(dir / "text.mp4", "This is a text, and not a video at all.\n");
  std::string noise;
  for (unsigned i = 0, x = 1; i < 20000; ++i) noise += char((x = x * 1664525 + 1013904223) >> 24);
  write_text(dir / "noise.mkv", noise);
  write_text(dir / "noise", noise);
  for (const char* name : {"empty.mp4", "text.txt", "text.mp4", "noise.mkv", "noise", "missing.mp4",
                           "missing%d.png", "*.jpg", "no folder/a.mp4"}) {
    EXPECT_EQ(kind_of([&] { VideoReader::open(dir / name); }), ErrorKind::kInput) << name;
  }
  EXPECT_EQ(kind_of([&] { VideoReader::open(dir.path() / ""); }), ErrorKind::kInput);
}

TEST(Damage, Mp4WithoutItsEndCannotBeRead) {
  const TempDir dir;
  write_clip(dir / "a.mp4", moving_pattern(64, 48, 3, 20));
  const std::string bytes = read_text(dir / "a.mp4");
  for (const std::size_t part : {std::size_t(40), bytes.size() / 2, bytes.size() - 100}) {
    write_text(dir / "b.mp4", bytes.substr(0, part));
    EXPECT_EQ(kind_of([&] { VideoReader::open(dir / "b.mp4"); }), ErrorKind::kInput) << part;
  }
}

TEST(Damage, MatroskaWithoutItsEndGivesWhatIsThere) {
  const TempDir dir;
  write_clip(dir / "a.mkv", moving_pattern(64, 48, 3, 20), with_codec("ffv1"));
  const std::string bytes = read_text(dir / "a.mkv");
  write_text(dir / "b.mkv", bytes.substr(0, bytes.size() / 2));
  const WholeClip clip = read_clip(dir / "b.mkv");
  EXPECT_GE(clip.frames.size(), 8u);
  EXPECT_LE(clip.frames.size(), 11u);
  EXPECT_FALSE(clip.warnings.empty());
  ReadOptions strict;
  strict.strict = true;
  EXPECT_EQ(kind_of([&] { read_clip(dir / "b.mkv", strict); }), ErrorKind::kInput);
}

/// It tells of no length, and libav says nothing.
TEST(Damage, YuvCutInsideAFrameIsTold) {
  const TempDir dir;
  write_clip(dir / "a.y4m", moving_pattern(64, 48, 3, 12));
  EXPECT_TRUE(read_clip(dir / "a.y4m").warnings.empty());
  const std::string bytes = read_text(dir / "a.y4m");
  ReadOptions strict;
  strict.strict = true;
  for (const std::size_t part : {bytes.size() / 2, bytes.size() - 1}) {
    write_text(dir / "b.y4m", bytes.substr(0, part));
    const WholeClip clip = read_clip(dir / "b.y4m");
    EXPECT_EQ(clip.frames.size(), part == bytes.size() - 1 ? 11u : 5u);
    EXPECT_EQ(clip.warnings, std::vector<std::string>{"the input ends early: cut short or damaged"});
    EXPECT_EQ(kind_of([&] { read_clip(dir / "b.y4m", strict); }), ErrorKind::kInput);
  }
}

class CutAtTheEnd : public testing::TestWithParam<std::pair<const char*, const char*>> {};

/// Less than a frame is missing, or a few: the times do not tell.
TEST_P(CutAtTheEnd, IsTold) {
  const TempDir dir;
  const auto [name, codec] = GetParam();
  write_clip(dir / name, moving_pattern(64, 48, 3, 30), with_codec(codec));
  ReadOptions strict;
  strict.strict = true;
  EXPECT_TRUE(read_clip(dir / name, strict).warnings.empty());
  const std::string bytes = read_text(dir / name);
  for (const std::size_t missing : {std::size_t(1), std::size_t(7), bytes.size() / 30, bytes.size() / 12}) {
    const std::string cut = dir / ("cut" + std::string(name));
    write_text(cut, bytes.substr(0, bytes.size() - missing));
    EXPECT_FALSE(read_clip(cut).warnings.empty()) << missing;
    EXPECT_EQ(kind_of([&] { read_clip(cut, strict); }), ErrorKind::kInput) << missing;
  }
}

INSTANTIATE_TEST_SUITE_P(Containers, CutAtTheEnd,
                         testing::Values(std::pair("a.mkv", "ffv1"), std::pair("b.mkv", "h264"),
                                         std::pair("a.webm", "vp9"), std::pair("a.ogv", ""),
                                         std::pair("a.gif", ""), std::pair("a.apng", ""),
                                         std::pair("a.mjpeg", "")));

/// Where whole packets are missing nothing tells of it.
TEST(Damage, TransportStreamsCutInsideAPacketAreTold) {
  const TempDir dir;
  write_clip(dir / "a.ts", moving_pattern(64, 48, 3, 30), with_codec("h264"));
  EXPECT_TRUE(read_clip(dir / "a.ts").warnings.empty());
  const std::string bytes = read_text(dir / "a.ts");
  write_text(dir / "b.ts", "caught inside a packet" + bytes);
  EXPECT_TRUE(read_clip(dir / "b.ts").warnings.empty());
  for (const std::size_t missing : {1, 100, 189}) {
    write_text(dir / "b.ts", bytes.substr(0, bytes.size() - missing));
    EXPECT_FALSE(read_clip(dir / "b.ts").warnings.empty()) << missing;
  }
}

/// What libav tells of it is beside the frame before the one that lacks something.
TEST(Damage, FramesWithAGapInATransportStreamAreShown) {
  const TempDir dir;
  WriteOptions options = with_codec("h264");
  options.crf = 5;
  write_clip(dir / "a.ts", moving_pattern(128, 96, 3, 25), options);
  std::string bytes = read_text(dir / "a.ts");
  constexpr std::size_t kPacket = 188;
  std::size_t at = bytes.size() / 2 / kPacket * kPacket;
  // One of the video, number 0x100, in which no frame begins.
  while (bytes.at(at + 1) != 1 || bytes.at(at + 2) != 0) at += kPacket;
  write_text(dir / "b.ts", bytes.erase(at, kPacket));
  const WholeClip clip = read_clip(dir / "b.ts");
  EXPECT_EQ(clip.frames.size(), 25u);
  EXPECT_GE(clip.damaged, 1u);
  EXPECT_FALSE(clip.warnings.empty());
  ReadOptions strict;
  strict.strict = true;
  EXPECT_EQ(kind_of([&] { read_clip(dir / "b.ts", strict); }), ErrorKind::kInput);
}

TEST(Damage, IsCountedAndStrictlyAnError) {
  const TempDir dir;
  write_clip(dir / "a.mp4", moving_pattern(320, 240, 3, 20), with_codec("h264"));
  std::string bytes = read_text(dir / "a.mp4");
  for (std::size_t i = 0; i < 400; ++i) bytes[bytes.size() / 2 + i] = 0;
  write_text(dir / "b.mp4", bytes);
  ReadOptions options;
  options.threads = 1;  // several may be too late to tell that a frame was mended
  const WholeClip clip = read_clip(dir / "b.mp4", options);
  EXPECT_GE(clip.frames.size(), 15u);
  EXPECT_GT(clip.damaged, 0u);
  EXPECT_GE(clip.warnings.size(), 1u);
  ReadOptions strict;
  strict.strict = true;
  EXPECT_EQ(kind_of([&] { read_clip(dir / "b.mp4", strict); }), ErrorKind::kInput);
}

TEST(Damage, OfFfv1IsToldByItsChecksums) {
  const TempDir dir;
  write_clip(dir / "a.mkv", moving_pattern(320, 240, 3, 12), with_codec("ffv1"));
  const WholeClip whole = read_clip(dir / "a.mkv");
  EXPECT_EQ(whole.damaged, 0u);
  std::string bytes = read_text(dir / "a.mkv");
  bytes[bytes.size() / 2] ^= 0x10;
  write_text(dir / "b.mkv", bytes);
  for (const int threads : {1, 3}) {
    ReadOptions options;
    options.threads = threads;
    const WholeClip clip = read_clip(dir / "b.mkv", options);
    EXPECT_EQ(clip.frames.size(), 12u);
    EXPECT_EQ(clip.damaged, 1u);
    EXPECT_EQ(clip.warnings.size(), 1u);
    options.strict = true;
    EXPECT_EQ(kind_of([&] { read_clip(dir / "b.mkv", options); }), ErrorKind::kInput) << threads;
    EXPECT_NO_THROW(read_clip(dir / "a.mkv", options));
  }
}

TEST(Damage, NeverDoesMoreThanToFail) {
  const TempDir dir;
  for (const char* name : {"a.mp4", "a.mkv", "a.avi"}) {
    write_clip(dir / name, moving_pattern(64, 48, 3, 6));
    const std::string whole = read_text(dir / name);
    for (unsigned seed = 1; seed <= 40; ++seed) {
      std::string bytes = whole;
      for (unsigned i = 0, x = seed; i < 20; ++i) {
        x = x * 1664525 + 1013904223;
        bytes[x % bytes.size()] = char(x >> 24);
      }
      write_text(dir / name, bytes);
      try {
        read_clip(dir / name);
      } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::kInput) << e.what();
      }
    }
  }
}

}  // namespace
}  // namespace knotreel::video
