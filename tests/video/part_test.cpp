// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "clips.h"
#include "support/libav_clips.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::TempDir;

ReadOptions part(std::uint64_t first, std::uint64_t count) {
  ReadOptions options;
  options.part.first = first;
  options.part.count = count;
  return options;
}

bool equal_bytes(const Packet& a, const Packet& b) {
  return a.stream() == b.stream() && std::ranges::equal(a.bytes(), b.bytes());
}

/// Whether a part has the frames and the packets that the whole has at that time.
void expect_part(const WholeClip& part, const WholeClip& whole, std::size_t first, std::size_t count) {
  ASSERT_EQ(part.frames.size(), count);
  for (std::size_t i = 0; i < count; ++i) {
    const Frame& expected = whole.frames[first + i];
    EXPECT_EQ(part.frames[i].index, i);
    EXPECT_EQ(part.frames[i].pts, expected.pts);
    EXPECT_EQ(part.frames[i].duration, expected.duration);
    EXPECT_EQ(part.frames[i].image.samples, expected.image.samples);
  }
  const bool has_begin = first > 0, has_end = first + count < whole.frames.size();
  const double tick = whole.info.time_base.value();
  const double begin = double(whole.frames[first].pts) * tick;
  const double end = double(part.frames.back().pts + part.frames.back().duration) * tick;
  std::vector<Packet> expected;
  for (const Packet& p : whole.packets) {
    if ((!has_begin || p.seconds() >= begin) && (!has_end || p.seconds() < end)) expected.push_back(p);
  }
  ASSERT_EQ(part.packets.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_TRUE(equal_bytes(part.packets[i], expected[i])) << i;
}

class Part : public testing::TestWithParam<const char*> {};

TEST_P(Part, HasTheFramesAndTheSoundOfItsTime) {
  const TempDir dir;
  const std::string path = dir / GetParam();
  write_sound_clip(path, "aac", true);
  const WholeClip whole = read_clip(path);
  ASSERT_EQ(whole.frames.size(), 25u);
  ASSERT_GT(whole.packets.size(), 10u);
  for (const auto& [first, count] :
       {std::pair<std::size_t, std::size_t>{0, 1}, {0, 7}, {3, 5}, {20, 5}, {24, 1}}) {
    SCOPED_TRACE(std::to_string(first) + " and " + std::to_string(count) + " frames");
    expect_part(read_clip(path, part(first, count)), whole, first, count);
  }
  expect_part(read_clip(path, part(20, 0)), whole, 20, 5);
  expect_part(read_clip(path, part(20, 100)), whole, 20, 5);
}

INSTANTIATE_TEST_SUITE_P(Containers, Part, testing::Values("a.mp4", "a.mkv"));

TEST(Parts, BeginAtZeroWhereTheyAreWritten) {
  const TempDir dir;
  write_sound_clip(dir / "a.mp4", "aac", true);
  EXPECT_EQ(VideoReader::open(dir / "a.mp4", part(10, 5)).info().frames, 5u);
  copy_clip(dir / "a.mp4", dir / "b.mp4", part(10, 5));
  const WholeClip whole = read_clip(dir / "a.mp4"), copy = read_clip(dir / "b.mp4");
  ASSERT_EQ(copy.frames.size(), 5u);
  const double begin = seconds(whole)[10];
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(seconds(copy)[i], seconds(whole)[10 + i] - begin, 1e-9);
  ASSERT_FALSE(copy.packets.empty());
  const auto first =
      std::ranges::find_if(whole.packets, [&](const Packet& p) { return p.seconds() >= begin; });
  EXPECT_TRUE(std::ranges::equal(copy.packets.front().bytes(), first->bytes()));
  EXPECT_NEAR(copy.packets.front().seconds(), first->seconds() - begin, 1e-4);
}

TEST(Parts, OfPicturesAreCountedToo) {
  const TempDir dir;
  write_clip(dir / "f_%02d.png", moving_pattern(32, 24, 3, 6));
  const WholeClip whole = read_clip(dir / "f_%02d.png");
  ASSERT_EQ(whole.frames.size(), 6u);
  expect_part(read_clip(dir / "f_%02d.png", part(2, 3)), whole, 2, 3);
}

ReadOptions between(double start, double end) {
  ReadOptions options;
  options.part.start = start;
  if (end > 0) options.part.end = end;
  return options;
}

/// Of a clip of any rate, times before a frame and at it.
TEST(Parts, AreFoundByTheirTimes) {
  const TempDir dir;
  for (const char* name : {"a.mp4", "a.mkv"}) {
    SCOPED_TRACE(name);
    write_sound_clip(dir / name, "aac", true);
    const WholeClip whole = read_clip(dir / name);
    std::vector<double> times = seconds(whole);
    for (double& t : times) t -= seconds(whole)[0];
    const double before = 0.001;
    for (const double early : {0.0, before}) {
      expect_part(read_clip(dir / name, between(times[3] - early, times[8] - early)), whole, 3, 5);
      expect_part(read_clip(dir / name, between(times[20] - early, 0)), whole, 20, 5);
      expect_part(read_clip(dir / name, between(0, times[7] - early)), whole, 0, 7);
    }
    expect_part(read_clip(dir / name, between(times[3] + before, 1000)), whole, 4, 21);
    EXPECT_EQ(VideoReader::open(dir / name, between(times[10], times[15])).info().frames, 5u);
    for (const ReadOptions& none : {between(times[3] + before, times[4] - before), between(1000, 0)}) {
      EXPECT_EQ(kind_of([&] { VideoReader::open(dir / name, none); }), ErrorKind::kInvalidArgument);
    }
  }
}

/// Frames before a time are found by the index of the file, and are the same as if all had been decoded.
TEST(Parts, OfLongFilesAreFoundByTheirIndex) {
  const TempDir dir;
  for (const char* name : {"a.mp4", "a.mkv"}) {
    SCOPED_TRACE(name);
    write_sound_clip(dir / name, "aac", true, 12);
    const WholeClip whole = read_clip(dir / name);
    ASSERT_EQ(whole.frames.size(), 300u);
    expect_part(read_clip(dir / name, between(7.52, 8)), whole, 188, 12);
    expect_part(read_clip(dir / name, between(11, 0)), whole, 275, 25);
    EXPECT_NEAR(double(VideoReader::open(dir / name, between(10, 0)).info().frames), 50, 1);  // an estimate
    EXPECT_EQ(kind_of([&] { VideoReader::open(dir / name, between(12.01, 0)); }),
              ErrorKind::kInvalidArgument);
  }
}

/// H.264 has frames that are shown later than they are decoded, and most of them need others.
TEST(Parts, BeginBetweenKeyframes) {
  const TempDir dir;
  for (const char* name : {"a.mp4", "a.mkv"}) {
    SCOPED_TRACE(name);
    write_clip(dir / name, moving_pattern(64, 48, 3, 620), with_codec("h264"));
    const WholeClip whole = read_clip(dir / name);
    for (const std::size_t first : {std::size_t{74}, std::size_t{260}, std::size_t{420}, std::size_t{619}}) {
      SCOPED_TRACE(first);
      const double start = seconds(whole)[first] - seconds(whole)[0];
      expect_part(read_clip(dir / name, between(start, start + 0.2)), whole, first,
                  std::min<std::size_t>(5, whole.frames.size() - first));
    }
  }
}

/// The pictures before a keyframe that are decoded behind it need some that a jump to it leaves out.
TEST(Parts, BeginInOpenGroupsOfPictures) {
  const TempDir dir;
  for (const char* name : {"a.mp4", "a.mkv"}) {
    SCOPED_TRACE(name);
    write_open_gop_clip(dir / name, 8);
    const WholeClip whole = read_clip(dir / name);
    ASSERT_EQ(whole.frames.size(), 200u);
    for (std::size_t first = 97; first < 104; ++first) {  // around a keyframe
      SCOPED_TRACE(first);
      const double start = seconds(whole)[first] - seconds(whole)[0];
      expect_part(read_clip(dir / name, between(start, start + 0.2)), whole, first, 5);
    }
  }
}

TEST(Parts, DoNotMeetDamageLongBeforeThem) {
  const TempDir dir;
  const std::string path = dir / "a.mkv";
  write_clip(path, moving_pattern(64, 48, 3, 200), with_codec("ffv1"));
  const WholeClip whole = read_clip(path);
  std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
  file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(path) / 20));
  file << "damage";
  file.close();
  EXPECT_GT(read_clip(path).damaged, 0u);
  const WholeClip part = read_clip(path, between(6, 0));
  EXPECT_EQ(part.damaged, 0u);
  expect_part(part, whole, 150, 50);
  ReadOptions strict = between(6, 0);
  strict.strict = true;
  EXPECT_EQ(kind_of([&] { VideoReader::open(path, strict); }), ErrorKind::kInput);
}

TEST(Parts, BehindTheEndAreAnError) {
  const TempDir dir;
  write_sound_clip(dir / "a.mp4", "aac", true);
  EXPECT_EQ(kind_of([&] { VideoReader::open(dir / "a.mp4", part(25, 1)); }), ErrorKind::kInvalidArgument);
}

}  // namespace
}  // namespace knotreel::video
