// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <numeric>

#include "clips.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::TempDir;

ClipSpec variable_rate() {
  ClipSpec clip = moving_pattern(64, 48, 3, 9);
  clip.info.time_base = {1, 90000};
  clip.pts = {0, 3003, 9000, 9001, 20000, 50000, 53003, 59999, 90000};
  for (std::size_t i = 0; i + 1 < clip.pts.size(); ++i) clip.durations[i] = clip.pts[i + 1] - clip.pts[i];
  clip.durations.back() = 7777;
  return clip;
}

class ExactTimes : public testing::TestWithParam<const char*> {};

TEST_P(ExactTimes, SurviveAVariableRate) {
  const TempDir dir;
  const ClipSpec clip = variable_rate();
  write_clip(dir / GetParam(), clip, with_codec("h264"));
  const WholeClip back = read_clip(dir / GetParam());
  EXPECT_EQ(back.info.time_base, clip.info.time_base);
  ASSERT_EQ(back.frames.size(), clip.pts.size());
  for (std::size_t i = 0; i < clip.pts.size(); ++i) {
    EXPECT_EQ(back.frames[i].index, i);
    EXPECT_EQ(back.frames[i].pts, clip.pts[i]);
    EXPECT_EQ(back.frames[i].duration, clip.durations[i]) << i;
  }
}

TEST_P(ExactTimes, SurviveALateStart) {
  const TempDir dir;
  ClipSpec clip = variable_rate();
  for (std::int64_t& pts : clip.pts) pts += 12345;
  write_clip(dir / GetParam(), clip, with_codec("h264"));
  const WholeClip back = read_clip(dir / GetParam());
  ASSERT_EQ(back.frames.size(), clip.pts.size());
  for (std::size_t i = 0; i < clip.pts.size(); ++i) EXPECT_EQ(back.frames[i].pts, clip.pts[i]);
  EXPECT_EQ(back.frames.back().duration, clip.durations.back());
}

INSTANTIATE_TEST_SUITE_P(Containers, ExactTimes, testing::Values("a.mp4", "a.mov"));

TEST(Times, AreMillisecondsInMatroska) {
  const TempDir dir;
  ClipSpec clip = variable_rate();
  clip.pts[3] = 9500;
  for (const char* name : {"a.mkv", "a.webm"}) {
    write_clip(dir / name, clip);
    const std::vector<double> back = seconds(read_clip(dir / name));
    ASSERT_EQ(back.size(), clip.pts.size());
    for (std::size_t i = 0; i < back.size(); ++i) EXPECT_NEAR(back[i], double(clip.pts[i]) / 90000, 0.00051);
  }
}

TEST(Times, OfTelevisionRatesAreExactInMp4) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(64, 48, 3, 30);
  clip.info.time_base = {1001, 30000};
  clip.info.frame_rate = {30000, 1001};
  write_clip(dir / "a.mp4", clip);
  const WholeClip back = read_clip(dir / "a.mp4");
  EXPECT_EQ(back.info.frame_rate, clip.info.frame_rate);
  EXPECT_EQ(back.info.time_base, (Rational{1, 30000}));
  ASSERT_EQ(back.frames.size(), 30u);
  EXPECT_EQ(back.frames[29].pts, 29 * 1001);
  EXPECT_EQ(back.frames[29].duration, 1001);
}

TEST(Times, OfASingleFrameKeepItsDuration) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(64, 48, 3, 1);
  clip.durations = {50};
  for (const char* name : {"a.mp4", "a.mkv", "a.webm", "a.y4m", "a.avi"}) {
    write_clip(dir / name, clip);
    const WholeClip back = read_clip(dir / name);
    ASSERT_EQ(back.frames.size(), 1u) << name;
    EXPECT_FALSE(back.info.still);
    EXPECT_TRUE(std::string(name) != "a.mp4" || back.frames[0].duration == 50);
  }
}

TEST(Times, AreMovedWithAWarningWhereTheRateIsFixed) {
  const TempDir dir;
  const ClipSpec clip = variable_rate();
  VideoWriter writer = VideoWriter::create(dir / "a.avi", clip.info);
  for (std::size_t i = 0; i < clip.pts.size(); ++i)
    writer.write(clip.images[i], clip.pts[i], clip.durations[i]);
  writer.finish();
  EXPECT_EQ(writer.warnings().size(), 1u);
  EXPECT_EQ(read_clip(dir / "a.avi").frames.size(), 9u);
}

/// The average of a rate that varies has large numbers, which MPEG-4 does not take.
TEST(Times, OfAnyRateAreForMpeg4) {
  const TempDir dir;
  ClipSpec clip = variable_rate();
  clip.info.frame_rate = {750000, 71393};
  write_clip(dir / "a.avi", clip);
  write_clip(dir / "a.mkv", clip, with_codec("mpeg4"));
  for (const char* name : {"a.avi", "a.mkv"}) {
    const WholeClip back = read_clip(dir / name);
    EXPECT_EQ(back.frames.size(), 9u);
    EXPECT_NEAR(back.info.frame_rate.value(), 10.505, 0.01) << name;
  }
}

std::vector<std::string> warnings_of(const std::string& path, const ClipSpec& clip) {
  VideoWriter writer = VideoWriter::create(path, clip.info);
  for (std::size_t i = 0; i < clip.images.size(); ++i)
    writer.write(clip.images[i], clip.pts[i], clip.durations[i]);
  writer.finish();
  return writer.warnings();
}

/// Neither the milliseconds of Matroska nor the time of the first frame, which may lie between two ticks.
TEST(Times, WhichTheSourceHasRoundedAreNotMoved) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(64, 48, 3, 24);
  clip.info.frame_rate = {24, 1};
  clip.info.time_base = {1, 1000};
  for (const std::int64_t first : {0, 21, 23}) {
    for (std::size_t i = 0; i < 24; ++i) clip.pts[i] = first + std::int64_t(i) * 1000 / 24;
    for (const char* name : {"a.avi", "a.h264", "a.y4m"}) {
      EXPECT_TRUE(warnings_of(dir / name, clip).empty()) << name << first;
      EXPECT_EQ(read_clip(dir / name).frames.size(), 24u);
    }
    const WholeClip back = read_clip(dir / "a.avi");
    // The first one may stay longer: AVI has no late start.
    for (std::size_t i = 2; i < 24; ++i) EXPECT_EQ(back.frames[i].pts - back.frames[i - 1].pts, 1) << first;
  }
  clip.pts.back() += 3;
  EXPECT_EQ(warnings_of(dir / "b.avi", clip),
            std::vector<std::string>{"1 frames are moved in time, because this output has a fixed rate"});
}

/// x264 tells how fine its clock is in place of a rate that varies, and nothing else in the file does.
TEST(Times, OfTransportStreamsDoNotTellTicksForFrames) {
  const TempDir dir;
  ClipSpec clip = variable_rate();
  clip.info.frame_rate = {9, 1};
  write_clip(dir / "a.ts", clip, with_codec("h264"));
  const WholeClip back = read_clip(dir / "a.ts");
  EXPECT_EQ(back.info.frame_rate, (Rational{9, 1}));
  ASSERT_EQ(back.frames.size(), 9u);
  for (std::size_t i = 1; i < 9; ++i)
    EXPECT_EQ(back.frames[i].pts - back.frames[0].pts, clip.pts[i] - clip.pts[0]);
  // As other programs may write it.
  WriteOptions options = with_codec("h264");
  options.encoder_options["x264-params"] = "force-cfr=0";
  write_clip(dir / "b.ts", clip, options);
  EXPECT_LT(read_clip(dir / "b.ts").info.frame_rate.value(), 1000);
}

TEST(Times, OfRawStreamsComeFromTheRate) {
  const TempDir dir;
  write_clip(dir / "a.h264", moving_pattern(64, 48, 3, 12));
  const WholeClip back = read_clip(dir / "a.h264");
  EXPECT_FALSE(back.info.timestamps);
  EXPECT_EQ(back.info.time_base, (Rational{1, 25}));
  ASSERT_EQ(back.frames.size(), 12u);
  for (std::size_t i = 0; i < 12; ++i) EXPECT_EQ(back.frames[i].pts, std::int64_t(i));
  EXPECT_TRUE(back.warnings.empty());
}

/// Frames of a video with a clock that is much finer than its rate.
ClipSpec fine_clock(Rational rate, std::int64_t ticks) {
  ClipSpec clip = moving_pattern(64, 48, 3, 12);
  clip.info.frame_rate = rate;
  clip.info.time_base = {rate.den, rate.num * ticks};
  for (std::size_t i = 0; i < 12; ++i) {
    clip.pts[i] = std::int64_t(i) * ticks;
    clip.durations[i] = ticks;
  }
  return clip;
}

TEST(Times, OfStreamsThatTellOnlyARateAreThoseOfTheSource) {
  const TempDir dir;
  for (const char* name : {"a.h264", "a.hevc", "a.m1v", "a.m2v", "a.mpg", "a.vob", "a.ogv", "a.drc"}) {
    write_clip(dir / name, fine_clock({24, 1}, 512));
    const WholeClip back = read_clip(dir / name);
    EXPECT_EQ(back.info.frame_rate, (Rational{24, 1})) << name;
    ASSERT_EQ(back.frames.size(), 12u) << name;
    for (std::size_t i = 0; i < 12; ++i)
      EXPECT_NEAR(seconds(back)[i] - seconds(back)[0], double(i) / 24, 1e-4);
  }
}

TEST(Times, AreKeptByRepeatingFramesWhereOnlySomeRatesThereAre) {
  const TempDir dir;
  const ClipSpec clip = fine_clock({12, 1}, 1024);
  for (const char* name : {"a.mpg", "a.m1v"}) {
    write_clip(dir / name, clip);
    const WholeClip back = read_clip(dir / name);
    EXPECT_NEAR(back.info.frame_rate.value(), 23.976, 1e-3);
    ASSERT_EQ(back.frames.size(), 24u) << name;
    for (std::size_t i = 0; i < 24; ++i)
      EXPECT_LE(mean_difference(back.frames[i].image, clip.images[i / 2]), 8) << name << " " << i;
  }
  EXPECT_EQ(kind_of([&] {
              VideoWriter::create(dir / "b.mpg", fine_clock({120, 1}, 512).info);
            }),
            ErrorKind::kInvalidArgument);
}

TEST(Times, ThatLeadAnywhereDoNotFillTheDisk) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(16, 16, 3, 3);
  clip.pts = {0, 1, 1LL << 40};
  clip.durations = {1, 1, 1LL << 40};
  VideoWriter writer = VideoWriter::create(dir / "a.m1v", clip.info);
  for (std::size_t i = 0; i < 3; ++i) writer.write(clip.images[i], clip.pts[i], clip.durations[i]);
  writer.finish();
  ASSERT_EQ(writer.warnings().size(), 2u);
  EXPECT_EQ(writer.warnings()[0].find("1 gaps of more than ten minutes are cut short"), 0u);
  const WholeClip back = read_clip(dir / "a.m1v");
  EXPECT_EQ(back.frames.size(), 1u + 15000 + 15000);
  EXPECT_LE(mean_difference(back.frames.back().image, clip.images[2]), 8);
}

TEST(Times, BeyondThoseOfDocumentsCountAsNotTold) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(16, 16, 3, 4);
  clip.info.time_base = {1, 1000};
  clip.pts = {0, 40, 1LL << 56, (1LL << 56) + 40};
  clip.durations = {40, 40, 40, 40};
  write_clip(dir / "a.mkv", clip);
  const WholeClip back = read_clip(dir / "a.mkv");
  ASSERT_EQ(back.frames.size(), 4u);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_GT(back.frames[i].pts, back.frames[i - 1].pts);
    EXPECT_LT(back.frames[i].pts, 1LL << 53);
  }
  EXPECT_LT(back.info.end, 1LL << 53);
}

TEST(Times, OfMpegTransportStartAtZeroAgain) {
  const TempDir dir;
  write_clip(dir / "a.ts", moving_pattern(64, 48, 3, 5));
  WholeClip back = read_clip(dir / "a.ts");
  EXPECT_GT(back.info.start, 0);
  VideoWriter writer = VideoWriter::create(dir / "a.mp4", back.info);
  for (const Frame& frame : back.frames) writer.write(frame.image, frame.pts, frame.duration);
  writer.finish();
  EXPECT_EQ(read_clip(dir / "a.mp4").frames.at(0).pts, 0);
}

}  // namespace
}  // namespace knotreel::video
