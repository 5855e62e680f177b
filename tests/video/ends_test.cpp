// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstdint>

#include "clips.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::read_text;
using test::TempDir;
using test::write_text;

ReadOptions strictly() {
  ReadOptions options;
  options.strict = true;
  return options;
}

/// Six frames, the last of which is there for five seconds.
ClipSpec with_long_end() {
  ClipSpec clip = moving_pattern(64, 48, 3, 6);
  clip.durations.back() = 125;
  return clip;
}

double last_seconds(const WholeClip& clip) {
  return double(clip.frames.back().duration) * clip.info.time_base.value();
}

class LongEnd : public testing::TestWithParam<const char*> {};

/// And is not taken for frames that are missing.
TEST_P(LongEnd, OfTheLastFrameIsKept) {
  const TempDir dir;
  write_clip(dir / GetParam(), with_long_end());
  const WholeClip back = read_clip(dir / GetParam(), strictly());
  ASSERT_EQ(back.frames.size(), 6u);
  EXPECT_NEAR(last_seconds(back), 5, 0.011);
  EXPECT_TRUE(back.warnings.empty());
}

INSTANTIATE_TEST_SUITE_P(Containers, LongEnd,
                         testing::Values("a.mp4", "a.mov", "a.mkv", "a.webm", "a.avi", "a.wmv", "a.ogv",
                                         "a.gif", "a.apng"));

/// Which frames then are missing, and their times would be those of the last one that is there.
TEST(End, OfAFileThatIsCutIsNotThatOfALongFrame) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(64, 48, 3, 60);
  clip.durations.back() = 125;
  WriteOptions index_first = with_codec("h264");
  index_first.container_options["movflags"] = "+faststart";
  write_clip(dir / "a.mp4", clip, index_first);
  write_clip(dir / "a.mkv", clip);
  write_clip(dir / "a.avi", clip);
  for (const char* name : {"a.mp4", "a.mkv", "a.avi"}) {
    EXPECT_NEAR(last_seconds(read_clip(dir / name, strictly())), 5, 1e-9) << name;
    const std::string bytes = read_text(dir / name);
    write_text(dir / name, bytes.substr(0, bytes.size() * 6 / 10));
    const WholeClip back = read_clip(dir / name);
    EXPECT_LT(back.frames.size(), 55u) << name;
    EXPECT_LT(last_seconds(back), 0.2) << name;
    EXPECT_FALSE(back.warnings.empty()) << name;
    EXPECT_EQ(kind_of([&] { read_clip(dir / name, strictly()); }), ErrorKind::kInput) << name;
  }
}

/// As one that is still being copied may be.
TEST(End, OfAFileThatIsFilledUpWithZerosIsMissing) {
  const TempDir dir;
  for (const char* name : {"a.mkv", "a.avi"}) {
    write_clip(dir / name, moving_pattern(64, 48, 3, 60));
    std::string bytes = read_text(dir / name);
    bytes.replace(bytes.size() / 2, bytes.size(), bytes.size() - bytes.size() / 2, '\0');
    write_text(dir / name, bytes);
    EXPECT_FALSE(read_clip(dir / name).warnings.empty()) << name;
  }
}

/// As of a file that another program has cut, and whose tags it has kept.
TEST(End, InTheTagsOfMatroskaIsNoneBehindThatOfTheFile) {
  const TempDir dir;
  write_clip(dir / "a.mkv", moving_pattern(64, 48, 3, 30));
  std::string bytes = read_text(dir / "a.mkv");
  const std::size_t at = bytes.find("00:00:01.200");
  ASSERT_NE(at, std::string::npos);
  bytes[at + 7] = '9';
  write_text(dir / "a.mkv", bytes);
  const WholeClip back = read_clip(dir / "a.mkv", strictly());
  EXPECT_TRUE(back.warnings.empty());
  EXPECT_NEAR(last_seconds(back), 0.04, 1e-9);
}

/// libav finds what is missing only where it is a part of a packet.
TEST(End, OfNutIsItsIndex) {
  const TempDir dir;
  write_clip(dir / "a.nut", moving_pattern(64, 48, 3, 30));
  EXPECT_TRUE(read_clip(dir / "a.nut", strictly()).warnings.empty());
  const std::string bytes = read_text(dir / "a.nut");
  write_text(dir / "b.nut", bytes.substr(0, bytes.rfind("NX\xDD\x67")));
  const WholeClip back = read_clip(dir / "b.nut");
  EXPECT_EQ(back.frames.size(), 30u);
  EXPECT_FALSE(back.warnings.empty());
}

/// Frames of 0.1, 0.5 and 1 s. @param start  hundredths of a second.
ClipSpec slower_and_slower(std::int64_t start) {
  ClipSpec clip = moving_pattern(64, 48, 3, 3);
  clip.info.time_base = {1, 100};
  clip.pts = {start, start + 10, start + 60};
  clip.durations = {10, 50, 100};
  return clip;
}

TEST(End, OfGifsIsThatOfTheirLastFrame) {
  const TempDir dir;
  const ClipSpec clip = slower_and_slower(0);
  for (const char* name : {"a.gif", "a.apng"}) {
    write_clip(dir / name, clip);
    EXPECT_NEAR(last_seconds(read_clip(dir / name)), 1, 1e-3) << name;
  }
  ClipSpec one = moving_pattern(64, 48, 3, 1);
  one.info.time_base = {1, 100};
  one.durations = {20};
  write_clip(dir / "b.gif", one);
  EXPECT_NEAR(last_seconds(read_clip(dir / "b.gif")), 0.2, 1e-9);
  WriteOptions own;
  own.container_options["final_delay"] = "77";
  write_clip(dir / "c.gif", clip, own);
  EXPECT_NEAR(last_seconds(read_clip(dir / "c.gif")), 0.77, 1e-9);
}

std::uint32_t little_endian(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint32_t value = 0;
  for (std::size_t i = count; i > 0; --i) value = value << 8 | std::uint8_t(bytes[at + i - 1]);
  return value;
}

/// Milliseconds of the frames of an animated WebP, which libav 5.1 does not read.
std::vector<std::uint32_t> webp_durations(const std::string& bytes) {
  std::vector<std::uint32_t> durations;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    if (bytes.compare(at, 4, "ANMF") == 0) durations.push_back(little_endian(bytes, at + 20, 3));
    at += 8 + (little_endian(bytes, at + 4, 4) + 1) / 2 * 2;
  }
  return durations;
}

TEST(End, OfWebpIsThatOfItsLastFrame) {
  const TempDir dir;
  const ClipSpec clip = slower_and_slower(5);
  WriteOptions options;
  options.container = "webp";
  write_clip(dir / "a.webp", clip, options);
  EXPECT_EQ(webp_durations(read_text(dir / "a.webp")), (std::vector<std::uint32_t>{100, 500, 1000}));
}

TEST(End, OfMovingPicturesIsTheirBeginningAgain) {
  const TempDir dir;
  const ClipSpec clip = moving_pattern(64, 48, 3, 3);
  WriteOptions options;
  options.container = "webp";
  write_clip(dir / "a.webp", clip, options);
  write_clip(dir / "a.apng", clip);
  const std::string webp = read_text(dir / "a.webp"), apng = read_text(dir / "a.apng");
  EXPECT_EQ(little_endian(webp, webp.find("ANIM") + 12, 2), 0u);
  EXPECT_EQ(little_endian(apng, apng.find("acTL") + 8, 4), 0u);
  WriteOptions twice;
  twice.container_options["plays"] = "2";
  write_clip(dir / "b.apng", clip, twice);
  const std::string other = read_text(dir / "b.apng");
  EXPECT_EQ(other[other.find("acTL") + 11], 2);
}

/// With B-frames, what is decoded last is not what is shown last.
TEST(End, OfAMovieIsThatOfItsFramesWhereAGapIs) {
  const TempDir dir;
  for (const std::vector<std::int64_t>& pts : {std::vector<std::int64_t>{0, 100, 200, 20000, 20100},
                                               {0, 400, 800, 900, 1000},
                                               {0, 100, 200, 300, 2000},
                                               {0, 100, 2000, 2001, 2002},
                                               {0, 1, 2, 1000, 1700}}) {
    for (const std::size_t count : {pts.size(), pts.size() - 1}) {
      ClipSpec clip = moving_pattern(64, 48, 3, int(count));
      clip.info.time_base = {1, 1000};
      clip.info.frame_rate = {10, 1};
      for (std::size_t i = 0; i < count; ++i) {
        clip.pts[i] = pts[i];
        clip.durations[i] = i + 1 < count ? pts[i + 1] - pts[i] : 90;
      }
      write_clip(dir / "a.mp4", clip, with_codec("h264"));
      const WholeClip back = read_clip(dir / "a.mp4");
      ASSERT_EQ(back.frames.size(), count);
      EXPECT_EQ(back.info.end, clip.pts.back() + 90) << clip.pts.back();
      EXPECT_EQ(back.frames.back().pts, clip.pts.back());
      EXPECT_EQ(back.frames.back().duration, 90) << clip.pts.back();
    }
  }
}

}  // namespace
}  // namespace knotreel::video
