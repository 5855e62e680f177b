// SPDX-License-Identifier: GPL-3.0-or-later
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "clips.h"
#include "knotreel/base/input_file.h"
#include "knotreel/base/natural_order.h"
#include "knotreel/image/write_image.h"
#include "knotreel/video/picture_list.h"
#include "support/pictures.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::largest_difference;
using test::read_text;
using test::TempDir;
using test::write_text;

image::Image flat(int width, int height, float value) {
  image::Image image = image::make_image(width, height, 3);
  for (float& sample : image.samples) sample = value;
  return image;
}

/// Pictures of values 1, 2, 10, with names that sort otherwise by letters.
void write_pictures(const TempDir& dir) {
  for (const int i : {1, 2, 10})
    image::write_image(dir / ("f" + std::to_string(i) + ".png"), flat(8, 6, float(i)));
}

void expect_values(const WholeClip& clip, const std::vector<float>& values) {
  ASSERT_EQ(clip.frames.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(clip.frames[i].image.at(3, 3, 1), values[i]);
    EXPECT_EQ(clip.frames[i].pts, std::int64_t(i));
    EXPECT_EQ(clip.frames[i].duration, 1);
  }
}

TEST(Inputs, PicturesByPatternFolderAndGlob) {
  const TempDir dir;
  write_pictures(dir);
  write_text(dir / "notes.txt", "not a picture");
  for (const std::string input : {"f%d.png", "f*.png", "f?*.png", ""}) {
    const WholeClip clip = read_clip(dir / input);
    expect_values(clip, {1, 2, 10});
    EXPECT_FALSE(clip.info.still);
    EXPECT_EQ(clip.info.time_base, (Rational{1, 25}));
    EXPECT_EQ(clip.info.pixel_format, "rgb24");
  }
}

TEST(Inputs, PatternsWithDigitsTakeThoseOnly) {
  const TempDir dir;
  image::write_image(dir / "a_0001.png", flat(8, 6, 1));
  image::write_image(dir / "a_0002.png", flat(8, 6, 2));
  image::write_image(dir / "a_3.png", flat(8, 6, 3));
  expect_values(read_clip(dir / "a_%04d.png"), {1, 2});
  expect_values(read_clip(dir / "a_%d.png"), {3});
}

TEST(Inputs, NaturalOrder) {
  EXPECT_TRUE(natural_less("a2", "a10"));
  EXPECT_FALSE(natural_less("a10", "a2"));
  EXPECT_TRUE(natural_less("a", "a1"));
  EXPECT_TRUE(natural_less("a1", "a1b"));
  EXPECT_TRUE(natural_less("a01b2", "a1b10"));
  EXPECT_FALSE(natural_less("x", "x"));
  EXPECT_NE(natural_less("a01", "a1"), natural_less("a1", "a01"));
}

TEST(Inputs, PicturesOfOtherSizesAreScaledWithAWarning) {
  const TempDir dir;
  image::write_image(dir / "1.png", flat(8, 6, 50));
  image::write_image(dir / "2.png", flat(31, 17, 60));
  const WholeClip clip = read_clip(dir / "%d.png");
  ASSERT_EQ(clip.frames.size(), 2u);
  EXPECT_LE(largest_difference(clip.frames[1].image, flat(8, 6, 60)), 0.1);
  EXPECT_EQ(clip.warnings.size(), 1u);
}

TEST(Inputs, MissingNumbersAreTold) {
  const TempDir dir;
  for (const char* name : {"f3.png", "f4.png", "f8.png", "f10.png"}) {
    image::write_image(dir / name, flat(8, 6, 50));
  }
  const WholeClip clip = read_clip(dir / "f%d.png");
  ASSERT_EQ(clip.frames.size(), 4u);
  EXPECT_EQ(clip.frames[3].pts, 3);
  ASSERT_EQ(clip.warnings.size(), 1u);
  EXPECT_EQ(clip.warnings[0].find("4 numbers between"), 0u) << clip.warnings[0];
  EXPECT_EQ(read_clip(dir / "f*.png").warnings.size(), 0u);
}

TEST(Inputs, BrokenPicturesLeaveAGap) {
  const TempDir dir;
  write_pictures(dir);
  write_text(dir / "f2.png", read_text(dir / "f2.png").substr(0, 50));
  const WholeClip clip = read_clip(dir / "f%d.png");
  ASSERT_EQ(clip.frames.size(), 2u);
  EXPECT_EQ(clip.frames[1].pts, 2);
  EXPECT_EQ(clip.damaged, 1u);
  ReadOptions strict;
  strict.strict = true;
  EXPECT_EQ(kind_of([&] { read_clip(dir / "f%d.png", strict); }), ErrorKind::kInput);
}

TEST(Inputs, ASinglePictureIsStill) {
  const TempDir dir;
  const image::Image image = test::random_picture(9, 7, 4, 1);
  image::write_image(dir / "a.png", image, image::SampleType::u16);
  const WholeClip clip = read_clip(dir / "a.png");
  ASSERT_EQ(clip.frames.size(), 1u);
  EXPECT_LE(largest_difference(clip.frames[0].image, image), 0);
  EXPECT_TRUE(clip.info.still);
  EXPECT_EQ(clip.info.depth, 16);
  EXPECT_EQ(clip.info.frames, 1u);
}

TEST(Inputs, SizesMayChangeInMidStream) {
  const TempDir dir;
  write_clip(dir / "a.h264", moving_pattern(64, 48, 3, 5));
  write_clip(dir / "b.h264", moving_pattern(32, 32, 3, 4));
  write_text(dir / "c.h264", read_text(dir / "a.h264") + read_text(dir / "b.h264"));
  const WholeClip clip = read_clip(dir / "c.h264");
  ASSERT_EQ(clip.frames.size(), 9u);
  for (const Frame& frame : clip.frames) EXPECT_EQ(frame.image.width, 64);
  ASSERT_EQ(clip.warnings.size(), 1u);
  EXPECT_EQ(clip.warnings[0].substr(0, 2), "4 ");
}

/// libav goes by what H.264 tells of itself.
TEST(Inputs, RawStreamsHaveTheRateThatIsAskedFor) {
  const TempDir dir;
  write_clip(dir / "a.h264", moving_pattern(64, 48, 3, 4));
  EXPECT_EQ(read_clip(dir / "a.h264").info.frame_rate, (Rational{25, 1}));
  ReadOptions options;
  options.demuxer_options = {{"framerate", "30000/1001"}};
  const WholeClip clip = read_clip(dir / "a.h264", options);
  EXPECT_EQ(clip.info.frame_rate, (Rational{30000, 1001}));
  EXPECT_NEAR(seconds(clip).at(3), 3 * 1001 / 30000.0, 1e-9);
}

TEST(Inputs, RawPicturesNeedTheirSize) {
  const TempDir dir;
  const ClipSpec source = moving_pattern(16, 8, 3, 4);
  WriteOptions raw;
  raw.container = "rawvideo";
  raw.pixel_format = "rgb24";
  write_clip(dir / "a.raw", source, raw);
  ReadOptions options;
  options.format = "rawvideo";
  EXPECT_EQ(kind_of([&] { read_clip(dir / "a.raw", options); }), ErrorKind::kInput);
  options.demuxer_options = {{"video_size", "16x8"}, {"pixel_format", "rgb24"}, {"framerate", "50"}};
  const WholeClip clip = read_clip(dir / "a.raw", options);
  ASSERT_EQ(clip.frames.size(), 4u);
  EXPECT_EQ(clip.info.frame_rate, (Rational{50, 1}));
  EXPECT_LE(largest_difference(clip.frames[3].image, source.images[3]), 0);
  options.demuxer_options["nonsense"] = "1";
  EXPECT_EQ(kind_of([&] { read_clip(dir / "a.raw", options); }), ErrorKind::kInvalidArgument);
}

image::Image raw_picture(const TempDir& dir, const std::string& bytes, const std::string& format) {
  write_text(dir / "one.raw", bytes);
  ReadOptions options;
  options.format = "rawvideo";
  options.demuxer_options = {{"video_size", "16x8"}, {"pixel_format", format}};
  return read_clip(dir / "one.raw", options).frames.at(0).image;
}

/// Samples of 8 or 16 bits, one plane after the other, big endian or not.
std::string bytes_of(const std::vector<int>& samples, int size, bool big = false) {
  std::string bytes;
  for (const int s : samples) {
    if (size == 2 && big) bytes.push_back(char(s >> 8));
    bytes.push_back(char(s & 255));
    if (size == 2 && !big) bytes.push_back(char(s >> 8));
  }
  return bytes;
}

/// swscale does not read these; their samples are those of a format that it reads.
TEST(Inputs, SemiPlanarAndPackedPixelsAreThoseOfPlanarOnes) {
  const TempDir dir;
  for (const int depth : {8, 10}) {
    const int code = 1 << (depth - 8);
    std::vector<int> luma, blue, red;
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 16; ++x) luma.push_back((30 + 10 * x + 3 * y) * code + x % code);
      for (int x = 0; x < 8; ++x) {
        blue.push_back((90 + 9 * x) * code);
        red.push_back((150 - 9 * y) * code + x % code);
      }
    }
    const auto joined = [](std::vector<int> a, const std::vector<int>& b) {
      a.insert(a.end(), b.begin(), b.end());
      return a;
    };
    std::vector<int> pairs, packed;
    for (std::size_t i = 0; i < blue.size(); ++i) {
      pairs.insert(pairs.end(), {blue[i], red[i]});
      packed.insert(packed.end(), {luma[2 * i], blue[i], luma[2 * i + 1], red[i]});
    }
    const int size = depth > 8 ? 2 : 1;
    const image::Image planar = raw_picture(dir, bytes_of(joined(joined(luma, blue), red), size),
                                            depth > 8 ? "yuv422p10le" : "yuv422p");
    const std::vector<int> semi = joined(luma, pairs);
    if (depth == 8) {
      EXPECT_LE(largest_difference(raw_picture(dir, bytes_of(semi, 1), "nv16"), planar), 0);
      continue;
    }
    EXPECT_LE(largest_difference(raw_picture(dir, bytes_of(semi, 2), "nv20le"), planar), 0);
    EXPECT_LE(largest_difference(raw_picture(dir, bytes_of(semi, 2, true), "nv20be"), planar), 0);
    for (int& s : packed) s <<= 6;
    EXPECT_LE(largest_difference(raw_picture(dir, bytes_of(packed, 2, true), "y210be"), planar), 0);
  }
}

TEST(Inputs, SamplesThatAreNoNumbersAreRefused) {
  const TempDir dir;
  std::vector<float> samples(16 * 8, 0.5F);
  const auto picture = [&] {
    return raw_picture(dir, {reinterpret_cast<const char*>(samples.data()), 4 * samples.size()}, "grayf32le");
  };
  EXPECT_NEAR(picture().samples[77], 127.5, 1e-3);
  for (const float bad : {NAN, INFINITY, -INFINITY}) {
    samples[77] = bad;
    EXPECT_EQ(kind_of([&] { picture(); }), ErrorKind::kInput) << bad;
  }
}

TEST(Inputs, MosaicsOfSensorsAreInColour) {
  const TempDir dir;
  for (const bool deep : {false, true}) {
    std::vector<int> mosaic;  // every fourth sample is red, and bright
    for (int y = 0; y < 8; ++y) {
      for (int x = 0; x < 16; ++x) mosaic.push_back((y % 2 == 0 && x % 2 == 0 ? 200 : 40) * (deep ? 257 : 1));
    }
    const image::Image image =
        raw_picture(dir, bytes_of(mosaic, deep ? 2 : 1), deep ? "bayer_rggb16le" : "bayer_rggb8");
    for (int y = 2; y < 6; ++y) {
      for (int x = 2; x < 14; ++x) {
        EXPECT_NEAR(image.at(x, y, 0), 200, 1) << x << ", " << y;
        EXPECT_NEAR(image.at(x, y, 1), 40, 1) << x << ", " << y;
        EXPECT_NEAR(image.at(x, y, 2), 40, 1) << x << ", " << y;
      }
    }
  }
}

/// A pipe out of which the bytes of a file come.
class Pipe {
 public:
  explicit Pipe(std::string bytes) {
    if (::pipe(ends_) != 0) throw std::runtime_error("no pipe");
    writer_ = std::thread([this, bytes = std::move(bytes)] {
      std::size_t done = 0;
      while (done < bytes.size()) {
        const ssize_t n = ::write(ends_[1], bytes.data() + done, bytes.size() - done);
        if (n <= 0) break;
        done += std::size_t(n);
      }
      ::close(ends_[1]);
    });
  }
  ~Pipe() {
    writer_.join();
    ::close(ends_[0]);
  }
  std::string name() const { return "/dev/fd/" + std::to_string(ends_[0]); }
  int end() const { return ends_[0]; }

 private:
  int ends_[2];
  std::thread writer_;
};

TEST(Inputs, PipesAreReadWithoutSeeking) {
  const TempDir dir;
  for (const char* name : {"a.mkv", "a.y4m", "a.avi", "a.h264"}) {
    write_clip(dir / name, moving_pattern(64, 48, 3, 20));
    const Pipe pipe(read_text(dir / name));
    EXPECT_EQ(read_clip(pipe.name()).frames.size(), 20u) << name;
  }
}

TEST(Inputs, StandardInput) {
  const TempDir dir;
  write_clip(dir / "a.mkv", moving_pattern(64, 48, 3, 20));
  const Pipe pipe(read_text(dir / "a.mkv"));
  const int before = ::dup(STDIN_FILENO);
  ::dup2(pipe.end(), STDIN_FILENO);
  const std::size_t frames = read_clip("-").frames.size();
  ::dup2(before, STDIN_FILENO);
  ::close(before);
  EXPECT_EQ(frames, 20u);
}

/// No file is there to be asked how long it should be.
TEST(Inputs, LongLastFramesOutOfPipesAreNoMissingOnes) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(64, 48, 3, 6);
  clip.durations.back() = 125;
  write_clip(dir / "a.mkv", clip, with_codec("ffv1"));
  const std::string bytes = read_text(dir / "a.mkv");
  const Pipe whole(bytes), cut(bytes.substr(0, bytes.size() * 3 / 4));
  const WholeClip back = read_clip(whole.name());
  EXPECT_TRUE(back.warnings.empty());
  EXPECT_EQ(back.frames.back().duration, 5000);
  EXPECT_FALSE(read_clip(cut.name()).warnings.empty());
}

TEST(Inputs, NamesWithColonsAndBlanksAreFiles) {
  const TempDir dir;
  const std::string path = dir / "http: a 10%.mkv";
  write_clip(path, moving_pattern(16, 16, 3, 2));
  EXPECT_EQ(read_clip(path).frames.size(), 2u);
}

TEST(Inputs, PicturesThatMoveAreVideos) {
  const TempDir dir;
  const ClipSpec clip = moving_pattern(64, 48, 3, 6);
  write_clip(dir / "a.mjpeg", clip);
  write_clip(dir / "a.apng", clip);
  std::filesystem::rename(dir / "a.apng", dir / "a.png");
  for (const char* name : {"a.mjpeg", "a.png"}) {
    EXPECT_FALSE(holds_one_picture(read_start(dir / name, kPictureStart), name));
    const WholeClip back = read_clip(dir / name);
    EXPECT_FALSE(back.info.still) << name;
    EXPECT_EQ(back.frames.size(), 6u) << name;
  }
  write_clip(dir / "b.png", moving_pattern(64, 48, 3, 1));
  EXPECT_TRUE(holds_one_picture(read_start(dir / "b.png", kPictureStart), "b.png"));
}

}  // namespace
}  // namespace knotreel::video
