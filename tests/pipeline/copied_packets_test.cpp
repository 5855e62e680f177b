// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cstring>

#include "knotreel/document/reader.h"
#include "knotreel/pipeline/render_job.h"
#include "knotreel/pipeline/run.h"
#include "support/libav_clips.h"
#include "support/temp_dir.h"

namespace knotreel::pipeline {
namespace {

constexpr double kFrame = 0.04;    // seconds of the clip's 25
constexpr double kSlack = 0.0011;  // Matroska counts milliseconds

struct Stream {
  std::vector<double> frames;  ///< seconds
  std::vector<video::Packet> packets;
};

Stream read_stream(const std::string& path) {
  video::VideoReader reader = video::VideoReader::open(path);
  Stream stream;
  const auto add = [&](const std::vector<video::Packet>& packets) {
    stream.packets.insert(stream.packets.end(), packets.begin(), packets.end());
  };
  video::Frame frame;
  while (reader.next(frame)) {
    stream.frames.push_back(double(frame.pts) * reader.info().time_base.value());
    add(frame.packets);
  }
  add(reader.remaining_packets());
  return stream;
}

/// A clip with a second of sound, its document, and videos rendered with the sound of the clip.
class RenderWithSound : public testing::Test {
 protected:
  RenderWithSound() {
    video::write_sound_clip(clip_, "aac", true);
    video::VideoReader reader = video::VideoReader::open(clip_);
    Job job;
    job.reader = &reader;
    job.source = "clip.mp4";
    job.cold = vectorize::preset_options(vectorize::Preset::kFast);
    job.cold.max_control_points = 20;
    job.document = dir_ / "clip.tcb";
    run_sequential(job);
  }

  Stream render(RenderJob job) {
    document::Reader document = document::Reader::open(dir_ / "clip.tcb");
    video::VideoReader sound = video::VideoReader::open(clip_);
    job.reader = &document;
    job.copied = &sound;
    job.video.path = dir_ / "back.mkv";
    run_render(job);
    return read_stream(job.video.path);
  }

  /// That the packets are those of the clip from one on, by so much earlier against the frames.
  void expect_packets(const Stream& back, std::size_t first, double earlier) {
    const Stream clip = read_stream(clip_);
    ASSERT_LE(first + back.packets.size(), clip.packets.size());
    // Matroska has no times before zero: everything moves together.
    const double shift = back.frames.at(0) - std::max(0.0, clip.frames.at(0) - earlier);
    for (std::size_t i = 0; i < back.packets.size(); ++i) {
      const auto a = back.packets[i].bytes(), b = clip.packets[first + i].bytes();
      ASSERT_EQ(a.size(), b.size()) << i;
      EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size()), 0) << i;
      EXPECT_NEAR(back.packets[i].seconds() - shift, clip.packets[first + i].seconds() - earlier, kSlack)
          << i;
    }
  }

  test::TempDir dir_;
  std::string clip_ = dir_ / "clip.mp4";
};

TEST_F(RenderWithSound, IsThatOfTheClip) {
  const Stream back = render({});
  EXPECT_EQ(back.frames.size(), 25u);
  EXPECT_EQ(back.packets.size(), read_stream(clip_).packets.size());
  expect_packets(back, 0, 0);
}

TEST_F(RenderWithSound, ComesAlongToAnotherRate) {
  RenderJob job;
  job.rate = {60, 1};
  const Stream back = render(job);
  EXPECT_EQ(back.frames.size(), 60u);
  EXPECT_EQ(back.packets.size(), read_stream(clip_).packets.size());
  expect_packets(back, 0, 0);
}

TEST_F(RenderWithSound, OfAPartIsItsOwn) {
  RenderJob job;
  job.first = 10;
  job.last = 14;
  const Stream back = render(job);
  EXPECT_EQ(back.frames.size(), 5u);
  const Stream clip = read_stream(clip_);
  std::size_t first = 0;
  while (clip.packets.at(first).seconds() < 10 * kFrame) ++first;
  EXPECT_NEAR(double(back.packets.size()), 5 * kFrame * 44100 / 1024, 1.0);
  EXPECT_LT(back.packets.back().seconds(), back.frames.front() + 5 * kFrame);
  expect_packets(back, first, 10 * kFrame);
}

TEST_F(RenderWithSound, IsNotThereUnlessAskedFor) {
  document::Reader document = document::Reader::open(dir_ / "clip.tcb");
  RenderJob job;
  job.reader = &document;
  job.video.path = dir_ / "back.mkv";
  run_render(job);
  EXPECT_TRUE(read_stream(job.video.path).packets.empty());
}

}  // namespace
}  // namespace knotreel::pipeline
