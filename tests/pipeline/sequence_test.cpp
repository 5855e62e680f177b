// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/pipeline/sequence.h"

#include <gtest/gtest.h>

#include <limits>

#include "knotreel/base/ticks.h"

namespace knotreel::pipeline {
namespace {

video::StreamInfo odd_stream() {
  video::StreamInfo stream;
  stream.width = 320;
  stream.height = 180;
  stream.channels = 4;
  stream.depth = 10;
  stream.pixel_format = "yuva420p10le";
  stream.time_base = {1, 90000};
  stream.frame_rate = {30000, 1001};
  stream.sample_aspect = {128, 117};
  stream.colour = {.range = 2, .matrix = 9, .primaries = 1, .transfer = 13, .chroma_location = 3};
  for (int i = 0; i < 36; ++i) stream.display_matrix.push_back(std::byte(7 * i));
  stream.start = -512;
  stream.end = 123456;
  return stream;
}

TEST(Sequence, ADocumentKeepsWhatAWriterWantsToKnow) {
  const video::StreamInfo before = odd_stream();
  const video::StreamInfo after = stream_info(sequence_info(before, "in.mov", 2));
  EXPECT_EQ(after.width, before.width);
  EXPECT_EQ(after.height, before.height);
  EXPECT_EQ(after.channels, before.channels);
  EXPECT_EQ(after.depth, before.depth);
  EXPECT_EQ(after.pixel_format, before.pixel_format);
  EXPECT_EQ(after.time_base, before.time_base);
  EXPECT_EQ(after.frame_rate, before.frame_rate);
  EXPECT_EQ(after.sample_aspect, before.sample_aspect);
  EXPECT_EQ(after.colour, before.colour);
  EXPECT_EQ(after.display_matrix, before.display_matrix);
  EXPECT_EQ(after.start, before.start);
  EXPECT_EQ(after.end, before.end);
}

TEST(Sequence, NonsenseInTheMetadataCountsAsUnknown) {
  document::SequenceInfo info = sequence_info(odd_stream(), "in.mov", 2);
  for (auto& [key, value] : info.metadata) value = "x" + value;
  const video::StreamInfo stream = stream_info(info);
  EXPECT_FALSE(stream.frame_rate.known());
  EXPECT_FALSE(stream.sample_aspect.known());
  EXPECT_EQ(stream.colour, video::ColourTags{});
  EXPECT_TRUE(stream.display_matrix.empty());
  EXPECT_EQ(stream.depth, 8);
  EXPECT_EQ(stream.end, 0);
}

TEST(Sequence, DepthsThatNoPictureHasCountAsUnknown) {
  document::SequenceInfo info = sequence_info(odd_stream(), "in.mov", 2);
  for (const char* depth : {"4294967312", "-10", "0", "33"}) {
    info.metadata["depth"] = depth;
    EXPECT_EQ(stream_info(info).depth, 8) << depth;
  }
  info.metadata["depth"] = "32";
  EXPECT_EQ(stream_info(info).depth, 32);
}

TEST(Sequence, TimesBeyondThoseOfDocumentsCountAsUnknown) {
  video::StreamInfo odd = odd_stream();
  odd.start = std::numeric_limits<std::int64_t>::min();
  odd.end = std::numeric_limits<std::int64_t>::max();
  const video::StreamInfo stream = stream_info(sequence_info(odd, "in.mov", 2));
  EXPECT_EQ(stream.start, 0);
  EXPECT_EQ(stream.end, 0);
  odd.frame_rate = {1, 0x7fffffff};
  odd.time_base = {1, 0x7fffffff};
  EXPECT_EQ(nominal_duration(odd), kMaxTicks);
}

TEST(Sequence, TheNominalDurationIsThatOfTheFrameRate) {
  EXPECT_EQ(nominal_duration(odd_stream()), 3003);
  EXPECT_EQ(nominal_duration({}), 0);
}

TEST(Sequence, ADocumentTellsOnlyADurationThatItsMetadataDoNot) {
  video::StreamInfo stream = odd_stream();
  stream.time_base = {1, 1000};
  stream.frame_rate = {25, 1};
  stream.end = 200;
  const document::SequenceInfo info = sequence_info(stream, "in.mov", 2);
  EXPECT_EQ(duration_to_tell(info, {150, 30, 50}), 0);
  EXPECT_EQ(duration_to_tell(info, {150, 30, 40}), 40);
  EXPECT_EQ(duration_to_tell(info, {0, 0, 200}), 200);  // far from the end the rate is what counts
  EXPECT_EQ(duration_to_tell(info, {0, 0, 40}), 0);
  stream.end = 0;
  stream.frame_rate = {};
  EXPECT_EQ(duration_to_tell(sequence_info(stream, "in.mov", 2), {150, 30, 30}), 0);
  EXPECT_EQ(duration_to_tell(sequence_info(stream, "in.mov", 2), {150, 30, 31}), 31);
}

}  // namespace
}  // namespace knotreel::pipeline
