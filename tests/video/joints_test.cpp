// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>

#include "clips.h"
#include "support/libav_clips.h"
#include "support/temp_dir.h"
#include "video/joined_times.h"

namespace knotreel::video {
namespace {

using test::TempDir;

struct Joined {
  const char* name;
  const char* codec;
};

std::ostream& operator<<(std::ostream& out, const Joined& c) {
  return out << c.name << ", " << c.codec;
}

/// Two files, one put behind the other, whose clocks begin at the same time.
class Joints : public testing::TestWithParam<Joined> {};

TEST_P(Joints, SoundStaysWithThePictures) {
  const TempDir dir;
  const std::string part = dir / GetParam().name, whole = dir / (std::string("w_") + GetParam().name);
  write_sound_clip(part, GetParam().codec, true, 2);
  test::write_text(whole, test::read_text(part) + test::read_text(part));
  const WholeClip one = read_clip(part), two = read_clip(whole);
  ASSERT_EQ(two.packets.size(), 2 * one.packets.size());
  const double shift = two.packets[one.packets.size()].seconds() - one.packets[0].seconds();
  EXPECT_NEAR(shift, 2.0, 0.1);
  for (std::size_t i = 0; i < one.packets.size(); ++i) {
    EXPECT_NEAR(two.packets[i].seconds(), one.packets[i].seconds(), 1e-4) << i;
    EXPECT_NEAR(two.packets[one.packets.size() + i].seconds(), one.packets[i].seconds() + shift, 1e-4) << i;
  }
  EXPECT_EQ(two.frames.size(), 2 * one.frames.size());
  EXPECT_EQ(two.damaged, 0u);
  EXPECT_NEAR(seconds(two).back(), seconds(one).back() + shift, 1e-4);
  EXPECT_EQ(std::count_if(two.warnings.begin(), two.warnings.end(),
                          [](const std::string& line) { return line.starts_with("1 joints"); }),
            1);
}

INSTANTIATE_TEST_SUITE_P(Containers, Joints,
                         testing::Values(Joined{"a.ts", "aac"}, Joined{"a.ts", "mp2"},
                                         Joined{"a.mpg", "mp2"}));

/// One stream of a transport stream.
class OneStream {
 public:
  OneStream() : parameters_(avcodec_parameters_alloc()) {
    parameters_->codec_type = AVMEDIA_TYPE_VIDEO;
    stream_.codecpar = parameters_;
    stream_.time_base = {1, 90000};
    stream_.pts_wrap_bits = 33;
  }
  ~OneStream() { avcodec_parameters_free(&parameters_); }
  OneStream(const OneStream&) = delete;
  OneStream& operator=(const OneStream&) = delete;

  /// Seconds that a packet is shown at, once it has been moved.
  double moved(std::int64_t dts, std::int64_t pts) {
    const PacketPtr packet = new_packet();
    packet->pts = pts;
    packet->dts = dts;
    packet->duration = 90000;
    times_.move(*packet, stream_);
    return double(packet->pts) / 90000;
  }

 private:
  AVCodecParameters* parameters_;
  AVStream stream_{};
  JoinedTimes times_;
};

/// The same for packets that are shown when they are decoded.
std::vector<double> moved(const std::vector<std::int64_t>& ticks) {
  OneStream stream;
  std::vector<double> result;
  for (const std::int64_t time : ticks) result.push_back(stream.moved(time, time));
  return result;
}

/// libav adds a run of the clock, 26 hours, to what is earlier than its start.
TEST(JoinedTimes, FollowAClockThatWasLater) {
  const std::int64_t run = std::int64_t{1} << 33;
  EXPECT_EQ(moved({900000, 990000, run, run + 90000}), (std::vector<double>{10, 11, 12, 13}));
}

TEST(JoinedTimes, KeepGaps) {
  EXPECT_EQ(moved({0, 90000, 3600 * 90000, 3601 * 90000}), (std::vector<double>{0, 1, 3600, 3601}));
}

TEST(JoinedTimes, LeavePicturesThatAreDecodedEarlierAlone) {
  OneStream stream;
  for (const int second : {0, 3, 1, 2, 6, 4, 5})
    EXPECT_EQ(stream.moved(AV_NOPTS_VALUE, second * 90000), second);
}

TEST(JoinedTimes, LeaveNonsenseAlone) {
  const std::int64_t far = kMaxTicks;
  EXPECT_EQ(moved({far, -far, far, 0}).size(), 4u);
  EXPECT_EQ(moved({AV_NOPTS_VALUE, 0, 90000}).back(), 1);
}

}  // namespace
}  // namespace knotreel::video
