// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/document/copier.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "document/independent_reader.h"
#include "document/sample_models.h"
#include "knotreel/base/error.h"
#include "knotreel/document/writer.h"

namespace knotreel {
namespace {

using document::Copier;
using document::FrameModel;
using document::Reader;
using testing::difference;

constexpr std::uint64_t kCopySeed = 78;
constexpr std::size_t kCopyFrames = 10;
constexpr std::size_t kSecondGroup = 6;

/// Two groups; some frames keep the topology, some swap knots, one changes nothing.
std::vector<std::byte> moving_document(int degree, const document::EncodeOptions& options = {}) {
  FrameModel model =
      testing::random_model(testing::random_mesh(160, 120, 120, 3, kCopySeed), degree, 3, kCopySeed);
  model.pts = 0;
  std::ostringstream out;
  document::Writer writer(out, testing::info_of(model), options);
  for (std::uint64_t f = 0; f < kCopyFrames; ++f) {
    const FrameModel stored = writer.append(model);
    model = f == 2 ? stored : testing::successor(stored, f % 3 == 1 ? 4 : 0, kCopySeed + f);
    model.frame = f + 1;
    model.pts = std::int64_t(3 * f + 3);
    model.keyframe = f + 1 == kSecondGroup;
  }
  writer.finish();
  return testing::bytes_of(out);
}

/// Frames of a document in this order, each following the one that it followed if that is there. Where that
/// is their order they keep their times.
std::vector<std::byte> copied(Reader& from, const std::vector<std::size_t>& frames, document::Steps steps) {
  std::ostringstream out;
  Copier copier(out, from.info(), steps);
  const bool ascending = std::ranges::is_sorted(frames);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    document::FrameRecord record = from.record(frames[i]);
    if (!ascending) record.pts = std::int64_t(i);
    const bool follows = i > 0 && frames[i] == frames[i - 1] + 1;
    EXPECT_EQ(copier.append(from, frames[i], {record.frame, record.pts, follows}),
              from.read(frames[i]).space->mesh().knots.size());
  }
  copier.finish();
  return testing::bytes_of(out);
}

std::vector<std::size_t> counted(std::size_t first, std::size_t end) {
  std::vector<std::size_t> frames;
  for (; first < end; ++first) frames.push_back(first);
  return frames;
}

/// Empty if the frames draw alike, whatever they are coded from.
std::string difference_in_kind(FrameModel a, const FrameModel& b) {
  a.function_ids = b.function_ids;
  a.keyframe = b.keyframe;
  return difference(a, b);
}

TEST(Copier, TheDurationOfTheLastFrameIsKeptIfItIsTold) {
  const FrameModel model =
      testing::random_model(testing::random_mesh(160, 120, 40, 0, kCopySeed), 2, 3, kCopySeed);
  for (const std::int64_t duration : {std::int64_t{0}, std::int64_t{1}, std::int64_t{500}}) {
    std::ostringstream out;
    document::Writer writer(out, testing::info_of(model));
    writer.append(model);
    writer.finish(duration);
    Reader reader = Reader::open(testing::bytes_of(out));
    EXPECT_TRUE(reader.complete());
    EXPECT_EQ(reader.last_duration(), duration);
    std::ostringstream again;
    Copier copier(again, reader.info(), reader.steps());
    copier.append(reader, 0, {0, model.pts});
    copier.finish(reader.last_duration());
    EXPECT_EQ(testing::bytes_of(again), testing::bytes_of(out));
  }
}

TEST(Copier, AWholeDocumentKeepsItsBytes) {
  for (int degree = 1; degree <= 3; ++degree) {
    const std::vector<std::byte> bytes = moving_document(degree);
    Reader reader = Reader::open(bytes);
    EXPECT_EQ(copied(reader, counted(0, kCopyFrames), reader.steps()), bytes) << degree;
  }
}

TEST(Copier, PartsHaveTheSameFramesAndKeyframesOnlyWhereTheyBegin) {
  for (int degree = 1; degree <= 3; ++degree) {
    Reader reader = Reader::open(moving_document(degree));
    for (std::size_t first = 0; first < kCopyFrames; ++first) {
      Reader part = Reader::open(copied(reader, counted(first, kCopyFrames), reader.steps()));
      ASSERT_EQ(part.frame_count(), kCopyFrames - first);
      for (std::size_t f = 0; f < part.frame_count(); ++f) {
        EXPECT_EQ(difference_in_kind(part.read(f), reader.read(first + f)), "") << first << " " << f;
        EXPECT_EQ(part.record(f).keyframe, f == 0 || first + f == kSecondGroup) << first << " " << f;
      }
    }
  }
}

TEST(Copier, FramesInAnyOrderAreKeyframes) {
  Reader reader = Reader::open(moving_document(2));
  const std::vector<std::size_t> order{7, 2, 3, 9, 0};
  Reader copy = Reader::open(copied(reader, order, reader.steps()));
  for (std::size_t i = 0; i < order.size(); ++i) {
    FrameModel original = reader.read(order[i]);
    original.pts = std::int64_t(i);
    EXPECT_EQ(difference_in_kind(copy.read(i), original), "") << i;
    EXPECT_EQ(copy.record(i).keyframe, order[i] != 3) << i;
  }
}

TEST(Copier, FrameStoredAsChangesIsReadByTheIndependentReader) {
  Reader reader = Reader::open(moving_document(2));
  const testing::IndependentModel model = testing::read_independently(copied(reader, {4}, reader.steps()));
  const FrameModel frame = reader.read(4);
  ASSERT_EQ(model.knots.size(), frame.space->mesh().knots.size());
  ASSERT_EQ(model.control.size(), frame.space->function_count());
  for (std::size_t f = 0; f < model.control.size(); ++f) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(model.control[f][2 + c], frame.colour[3 * f + c]);
  }
}

TEST(Copier, DocumentsOfDifferentStepsKeepTheirNumbers) {
  Reader coarse = Reader::open(moving_document(2, {.colour_step = 3, .displacement_step = 1 / 16.0}));
  Reader fine = Reader::open(moving_document(2, {.colour_step = 2, .displacement_step = 1 / 64.0}));
  const document::Steps steps = document::common_steps(coarse.steps(), fine.steps());
  EXPECT_LT(steps.colour, fine.steps().colour);
  std::ostringstream out;
  Copier copier(out, coarse.info(), steps);
  for (std::size_t f = 0; f < 4; ++f) copier.append(coarse, f, {f, std::int64_t(f), f > 0});
  for (std::size_t f = 0; f < 4; ++f) copier.append(fine, f, {4 + f, std::int64_t(4 + f), f > 0});
  copier.finish();
  Reader copy = Reader::open(testing::bytes_of(out));
  for (std::size_t f = 0; f < copy.frame_count(); ++f) {
    FrameModel original = (f < 4 ? coarse : fine).read(f % 4);
    original.frame = f;
    original.pts = std::int64_t(f);
    EXPECT_EQ(difference_in_kind(copy.read(f), original), "") << f;
    EXPECT_EQ(copy.record(f).keyframe, f % 4 == 0) << f;
  }
}

TEST(Copier, WhatDoesNotFitIsRefusedAndLeavesNothing) {
  Reader reader = Reader::open(moving_document(2));
  const document::Steps steps = reader.steps();
  const auto refused = [&](const document::SequenceInfo& info, document::Steps own, std::size_t frame) {
    std::ostringstream out;
    Copier copier(out, info, own);
    const std::size_t size = out.str().size();
    EXPECT_THROW(copier.append(reader, frame, {}), Error);
    EXPECT_EQ(out.str().size(), size);
  };
  document::SequenceInfo info = reader.info();
  refused(info, steps, kCopyFrames);
  refused(info, {steps.colour + 1, steps.displacement}, 0);
  refused(info, {steps.colour, 2 * steps.displacement}, 0);
  refused(info, {1, steps.displacement}, 0);  // units of colours would have to be above 255
  ++info.width;
  refused(info, steps, 0);
  info = reader.info();
  info.channels = 1;
  refused(info, steps, 0);
  info = reader.info();
  info.degree = 3;
  refused(info, steps, 0);
}

}  // namespace
}  // namespace knotreel
