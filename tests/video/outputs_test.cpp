// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "clips.h"
#include "knotreel/image/read_image.h"
#include "support/pictures.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::largest_difference;
using test::read_text;
using test::TempDir;
using test::write_text;

WriteOptions into(const std::string& container) {
  WriteOptions options;
  options.container = container;
  return options;
}

std::string digest_of(const ClipSpec& clip) {
  VideoWriter writer = VideoWriter::create("", clip.info, into("hash"));
  for (std::size_t i = 0; i < clip.images.size(); ++i)
    writer.write(clip.images[i], clip.pts[i], clip.durations[i]);
  writer.finish();
  return writer.digest();
}

TEST(Outputs, FilesAppearWhenFinished) {
  const TempDir dir;
  write_text(dir / "a.mp4", "old");
  {
    const ClipSpec clip = moving_pattern(64, 48, 3, 3);
    VideoWriter writer = VideoWriter::create(dir / "a.mp4", clip.info);
    writer.write(clip.images[0], 0, 1);
    EXPECT_EQ(dir.entries(), 2u);
  }
  EXPECT_EQ(dir.entries(), 1u);
  EXPECT_EQ(read_text(dir / "a.mp4"), "old");
}

TEST(Outputs, WhatWasWrittenSoFarCanBeFinished) {
  const TempDir dir;
  const ClipSpec clip = moving_pattern(64, 48, 3, 30);
  VideoWriter writer = VideoWriter::create(dir / "a.mp4", clip.info);
  for (std::size_t i = 0; i < 7; ++i) writer.write(clip.images[i], clip.pts[i], 1);
  writer.finish();
  EXPECT_EQ(read_clip(dir / "a.mp4").frames.size(), 7u);
  EXPECT_EQ(kind_of([&] { writer.write(clip.images[7], 7, 1); }), ErrorKind::kInvalidArgument);
}

TEST(Outputs, FullDisksAreToldWithTheName) {
  const ClipSpec clip = moving_pattern(64, 48, 3, 100);
  for (const char* container : {"matroska", "mp4", "rawvideo", "yuv4mpegpipe"}) {
    try {
      write_clip("/dev/full", clip, into(container));
      ADD_FAILURE() << container;
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kOutput);
      EXPECT_EQ(std::string(e.what()), "cannot write '/dev/full': No space left on device") << container;
    }
  }
}

TEST(Outputs, WhatCannotBeIsRefused) {
  const TempDir dir;
  const StreamInfo info = moving_pattern(64, 48, 3, 1).info;
  const auto refused = [&](const std::string& name, const WriteOptions& options) {
    EXPECT_EQ(kind_of([&] { VideoWriter::create(dir / name, info, options); }), ErrorKind::kInvalidArgument)
        << name;
    EXPECT_EQ(dir.entries(), 0u) << name;
  };
  refused("a.mp4", with_codec("nonsense"));
  refused("a.mp4", with_codec("aac"));
  refused("a.mp4", with_codec("h264", "nonsense"));
  refused("a.mp4", with_codec("h264", "gbrp16le"));
  refused("a.webm", with_codec("h264"));
  refused("a.nonsense", {});
  refused("a", {});
  refused("a.mp4", into("nonsense"));
  refused("a.mp4", into("hls"));
  WriteOptions preset;
  preset.preset = "nonsense";
  refused("a.mp4", preset);
  EXPECT_EQ(kind_of([&] { VideoWriter::create(dir / "no folder/a.mp4", info); }), ErrorKind::kOutput);
}

TEST(Outputs, FramesMustFit) {
  const ClipSpec clip = moving_pattern(64, 48, 3, 2);
  VideoWriter writer = VideoWriter::create("", clip.info, into("null"));
  writer.write(clip.images[0], 5, 1);
  EXPECT_EQ(kind_of([&] { writer.write(clip.images[1], 5, 1); }), ErrorKind::kInvalidArgument);
  EXPECT_EQ(kind_of([&] { writer.write(image::make_image(64, 47, 3), 6, 1); }), ErrorKind::kInvalidArgument);
  EXPECT_EQ(kind_of([&] { writer.write(image::Image{64, 48, 3, {}}, 6, 1); }), ErrorKind::kInvalidArgument);
  EXPECT_EQ(kind_of([&] { writer.write(image::make_image(64, 48, 4), 6, 1); }), ErrorKind::kInvalidArgument);
}

TEST(Outputs, HashesTellSamplesAndTimesApart) {
  const ClipSpec clip = moving_pattern(16, 8, 3, 3);
  const std::string digest = digest_of(clip);
  EXPECT_EQ(digest.size(), 7u + 64u);
  EXPECT_EQ(digest_of(clip), digest);
  ClipSpec other = clip;
  other.images[2].samples[17] += 1;
  EXPECT_NE(digest_of(other), digest);
  other = clip;
  other.pts[2] += 1;
  EXPECT_NE(digest_of(other), digest);
  other = clip;
  other.images[1].samples[0] += 0.2F;
  EXPECT_EQ(digest_of(other), digest);
  other.info.depth = 10;
  EXPECT_NE(digest_of(other), digest);
}

/// Of an encoder, with another pattern in all memory that comes from malloc() each time.
std::string stream_in_dirty_memory(const std::string& path, const ClipSpec& clip, int pattern) {
  ::mallopt(M_PERTURB, pattern);
  WriteOptions options;
  options.threads = 1;
  write_clip(path, clip, options);
  ::mallopt(M_PERTURB, 0);
  return read_text(path);
}

TEST(Outputs, StreamsDoNotDependOnOldMemory) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(320, 180, 3, 50);
  for (std::size_t i = 0; i < clip.images.size(); i += 3)  // something to look ahead for
    clip.images[i] = test::random_picture(320, 180, 3, unsigned(i));
  const std::string stream = stream_in_dirty_memory(dir / "a.h264", clip, 0x5A);
  EXPECT_GT(stream.size(), 1000u);
  for (const int pattern : {1, 0xA5, 0xFF})
    EXPECT_EQ(stream_in_dirty_memory(dir / "a.h264", clip, pattern), stream) << pattern;
}

TEST(Outputs, NumberedPictures) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(16, 8, 3, 3);
  clip.info.depth = 16;
  clip.images[1] = test::random_picture(16, 8, 3, 1);
  write_clip(dir / "out_%04d.png", clip);
  EXPECT_EQ(dir.entries(), 3u);
  EXPECT_LE(largest_difference(image::read_image(dir / "out_0002.png"), clip.images[1]), 0);
  EXPECT_EQ(kind_of([&] { write_clip(dir / "out_%04d.mp3", clip); }), ErrorKind::kInvalidArgument);
}

TEST(Outputs, OnePictureHoldsOneFrame) {
  const TempDir dir;
  write_clip(dir / "a.png", moving_pattern(16, 8, 3, 1));
  EXPECT_EQ(image::read_image(dir / "a.png").width, 16);
  write_text(dir / "b.png", "old");
  EXPECT_EQ(kind_of([&] { write_clip(dir / "b.png", moving_pattern(16, 8, 3, 2)); }),
            ErrorKind::kInvalidArgument);
  EXPECT_EQ(read_text(dir / "b.png"), "old");
}

/// What comes out of a pipe that a clip is written to.
WholeClip through_pipe(const ClipSpec& clip, const WriteOptions& options) {
  int ends[2];
  if (::pipe(ends) != 0) return {};
  std::string bytes;
  std::thread reader([&] {
    char buffer[4096];
    ssize_t n;
    while ((n = ::read(ends[0], buffer, sizeof buffer)) > 0) bytes.append(buffer, std::size_t(n));
  });
  write_clip("/dev/fd/" + std::to_string(ends[1]), clip, options);
  ::close(ends[1]);
  reader.join();
  ::close(ends[0]);
  const TempDir dir;
  write_text(dir / "a", bytes);
  return read_clip(dir / "a");
}

TEST(Outputs, PipesGetStreamsThatNeedNoSeeking) {
  for (const char* container : {"mp4", "matroska", "yuv4mpegpipe", "nut"}) {
    const WholeClip back = through_pipe(moving_pattern(64, 48, 3, 30), into(container));
    EXPECT_EQ(back.frames.size(), 30u) << container;
    const bool shifts =
        std::string(container) == "nut";  // by the delay of B-frames, as it cannot start below 0
    EXPECT_TRUE(shifts || back.frames.at(0).pts == 0) << container;
  }
}

TEST(Outputs, IndicesOfPipesCannotGoFirst) {
  WriteOptions options = into("mp4");
  options.container_options = {{"movflags", "+faststart"}};
  EXPECT_EQ(through_pipe(moving_pattern(64, 48, 3, 30), options).frames.size(), 30u);
}

TEST(Outputs, AnimatedWebp) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(64, 48, 3, 3);
  for (unsigned i = 0; i < 3; ++i) clip.images[i] = test::random_8bit_picture(64, 48, 3, i);
  const auto written = [&](double crf) {
    WriteOptions options = into("webp");
    options.crf = crf;
    write_clip(dir / "a.webp", clip, options);
    return read_text(dir / "a.webp");
  };
  const std::string bytes = written(-1);  // libav does not read them
  std::size_t frames = 0;
  for (std::size_t at = 0; (at = bytes.find("ANMF", at)) != std::string::npos; at += 4) ++frames;
  EXPECT_EQ(frames, 3u);
  EXPECT_LT(2 * written(80).size(), bytes.size());
  EXPECT_GT(written(0).size(), bytes.size());
}

struct Quality {
  const char* codec;
  double low;  ///< on the encoder's scale
};

std::ostream& operator<<(std::ostream& out, const Quality& q) {
  return out << q.codec;
}

class KnowsQuality : public testing::TestWithParam<Quality> {};

TEST_P(KnowsQuality, AndMakesSmallerFilesByIt) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(64, 48, 3, 6);
  for (unsigned i = 0; i < 6; ++i) clip.images[i] = test::random_8bit_picture(64, 48, 3, i);
  WriteOptions options = with_codec(GetParam().codec);
  write_clip(dir / "high.nut", clip, options);
  options.crf = GetParam().low;
  write_clip(dir / "low.nut", clip, options);
  const auto size = [&](const char* name) { return double(std::filesystem::file_size(dir / name)); };
  EXPECT_LT(size("low.nut"), 0.7 * size("high.nut"));
}

INSTANTIATE_TEST_SUITE_P(Encoders, KnowsQuality,
                         testing::Values(Quality{"h264", 40}, Quality{"hevc", 40}, Quality{"vp9", 50},
                                         Quality{"vp8", 40}, Quality{"av1", 50}, Quality{"mpeg4", 20},
                                         Quality{"mpeg2video", 20}, Quality{"mpeg1video", 20},
                                         Quality{"mjpeg", 20}, Quality{"msmpeg4", 20}, Quality{"wmv2", 20},
                                         Quality{"flv", 20}, Quality{"h263p", 20}, Quality{"theora", 9},
                                         Quality{"snow", 20}, Quality{"svq1", 20}, Quality{"libxvid", 20}));

TEST(Outputs, QualityThatAnEncoderDoesNotKnowIsTold) {
  const TempDir dir;
  WriteOptions options = with_codec("ffv1");
  const StreamInfo info = moving_pattern(64, 48, 3, 1).info;
  EXPECT_EQ(VideoWriter::create(dir / "a.mkv", info, options).warnings().size(), 0u);
  options.crf = 20;
  EXPECT_EQ(VideoWriter::create(dir / "a.mkv", info, options).warnings().size(), 1u);
}

TEST(Outputs, AlphaThatAnEncoderDoesNotKeepIsTold) {
  const TempDir dir;
  for (const int channels : {1, 2, 3, 4}) {
    const StreamInfo info = moving_pattern(64, 48, channels, 1).info;
    const auto warnings = [&](const char* codec) {
      return VideoWriter::create(dir / "a.mkv", info, with_codec(codec)).warnings().size();
    };
    EXPECT_EQ(warnings("h264"), channels % 2 == 0 ? 1u : 0u) << channels;
    EXPECT_EQ(warnings("ffv1"), 0u) << channels;
    EXPECT_EQ(warnings("prores"), 0u) << channels;
  }
}

TEST(Outputs, ChromaThatPlayersDoNotShowIsTold) {
  const TempDir dir;
  const auto warnings = [&](const char* name, const char* codec, const std::string& from, int width) {
    StreamInfo info = moving_pattern(width, 48, 3, 1).info;
    info.pixel_format = from;
    const std::vector<std::string> all = VideoWriter::create(dir / name, info, with_codec(codec)).warnings();
    return all.empty() ? "" : all[0].substr(all[0].find(';') + 2);
  };
  for (const char* codec : {"h264", "hevc"}) {
    EXPECT_EQ(warnings("a.mp4", codec, "rgb24", 64), "--pixel-format yuv420p is for those");
    EXPECT_EQ(warnings("a.mov", codec, "yuv420p", 65), "even sizes may have yuv420p");
    EXPECT_EQ(warnings("a.mp4", codec, "yuv420p", 64), "");
    EXPECT_EQ(warnings("a.mkv", codec, "rgb24", 64), "");
  }
  EXPECT_EQ(warnings("a.mov", "prores", "rgb24", 64), "");
}

TEST(Outputs, WithoutAlphaPicturesAreOnBlack) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(32, 16, 4, 1);
  clip.images[0] = test::random_8bit_picture(32, 16, 4, 1);
  WriteOptions options = with_codec("ffv1");
  options.pixel_format = "bgr0";
  write_clip(dir / "a.mkv", clip, options);
  const image::Image back = read_clip(dir / "a.mkv").frames.at(0).image;
  ASSERT_EQ(back.channels, 3);
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 32; ++x) {
      const image::Image& source = clip.images[0];
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(back.at(x, y, c), source.at(x, y, c) * source.at(x, y, 3) / 255, 0.501);
    }
  }
}

TEST(Outputs, DepthThatAnEncoderDoesNotKeepIsTold) {
  const TempDir dir;
  StreamInfo info = moving_pattern(64, 48, 3, 1).info;
  const auto warnings = [&](const WriteOptions& options) {
    return VideoWriter::create(dir / "a.mkv", info, options).warnings().size();
  };
  EXPECT_EQ(warnings(with_codec("mpeg4")), 0u);
  info.depth = 10;
  EXPECT_EQ(warnings(with_codec("mpeg4")), 1u);
  EXPECT_EQ(warnings(with_codec("h264")), 0u);
  WriteOptions asked_for = with_codec("h264");
  asked_for.pixel_format = "yuv420p";
  EXPECT_EQ(warnings(asked_for), 0u);
}

TEST(Outputs, QualityOfWhatIsNotEncodedIsTold) {
  const TempDir dir;
  const StreamInfo info = moving_pattern(64, 48, 3, 1).info;
  const auto warnings = [&](const char* name, WriteOptions options) {
    const auto without = VideoWriter::create(dir / name, info, options).warnings().size();
    EXPECT_EQ(without, 0u);
    options.crf = 20;
    return VideoWriter::create(dir / name, info, options).warnings().size();
  };
  EXPECT_EQ(warnings("", into("null")), 1u);
  EXPECT_EQ(warnings("", into("hash")), 1u);
  EXPECT_EQ(warnings("%d.png", {}), 1u);
  EXPECT_EQ(warnings("a.mp4", {}), 0u);
}

TEST(Outputs, OneThreadGivesTheSameBytesTwice) {
  const TempDir dir;
  for (const char* name : {"a.mp4", "b.mp4"}) {
    write_clip(dir / name, moving_pattern(64, 48, 3, 10), with_codec("h264"));
  }
  EXPECT_EQ(read_text(dir / "a.mp4"), read_text(dir / "b.mp4"));
}

}  // namespace
}  // namespace knotreel::video
