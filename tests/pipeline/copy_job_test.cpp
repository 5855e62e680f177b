// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/pipeline/copy_job.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <sstream>

#include "knotreel/base/error.h"
#include "knotreel/document/writer.h"
#include "support/models.h"
#include "support/temp_dir.h"

namespace knotreel::pipeline {
namespace {

constexpr std::size_t kJobFrames = 4;

/// A document whose frames differ in a colour.
std::vector<std::byte> four_frames() {
  document::FrameModel model = testing::blank_model(testing::MeshBuilder(16, 12).triangulated(), 2, 3);
  document::SequenceInfo info;
  info.width = 16;
  info.height = 12;
  info.degree = 2;
  std::ostringstream out;
  document::Writer writer(out, info);
  for (std::size_t f = 0; f < kJobFrames; ++f) {
    model.colour[0] = 12.0 * double(f);
    model.frame = f;
    model.pts = std::int64_t(f);
    model.keyframe = f == 0;
    writer.append(model);
  }
  writer.finish();
  const std::string text = out.str();
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

class CopyJobTest : public ::testing::Test {
 protected:
  CopyJob job() {
    CopyJob job;
    job.plan = plan_copy(
        {contents_of(document::Reader::open(bytes_), "a"), contents_of(document::Reader::open(bytes_), "b")},
        {25, 1});
    job.open = [this](std::size_t document) {
      opened_.push_back(document);
      return document::Reader::open(bytes_);
    };
    job.on_frame = [this](const FrameRow& row) { rows_.push_back(row); };
    return job;
  }
  std::string path(const std::string& name) const { return (dir_ / name).string(); }

  std::vector<std::byte> bytes_ = four_frames();
  std::vector<std::size_t> opened_;
  std::vector<FrameRow> rows_;
  test::TempDir dir_;
};

TEST_F(CopyJobTest, EachDocumentIsOpenedOnceAndEachFrameToldOf) {
  CopyJob job = this->job();
  job.document = path("out.tcb");
  const CopySummary summary = run_copy(job);
  EXPECT_EQ(opened_, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(summary.frames, 2 * kJobFrames);
  EXPECT_FALSE(summary.stopped);
  EXPECT_EQ(summary.document_bytes, std::filesystem::file_size(job.document));
  document::Reader copy = document::Reader::open(job.document);
  ASSERT_EQ(rows_.size(), copy.frame_count());
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    EXPECT_EQ(rows_[i].index, i);
    EXPECT_EQ(rows_[i].pts, copy.record(i).pts);
    EXPECT_EQ(rows_[i].bytes, copy.record(i).bytes);
    EXPECT_EQ(rows_[i].knots, copy.read(i).space->mesh().knots.size());
    EXPECT_EQ(copy.record(i).keyframe, i % kJobFrames == 0);
  }
}

TEST_F(CopyJobTest, SingleFramesAloneAndBesideADocumentAreTheSame) {
  CopyJob job = this->job();
  job.split_folder = path("alone");
  run_copy(job);
  job.split_folder = path("beside");
  job.document = path("out.tcb");
  run_copy(job);
  for (std::size_t i = 1; i <= 2 * kJobFrames; ++i) {
    const std::string name = "frame_00000" + std::to_string(i) + ".tcb";
    const std::string alone = test::read_text(path("alone/" + name));
    EXPECT_FALSE(alone.empty());
    EXPECT_TRUE(alone == test::read_text(path("beside/" + name))) << name;
  }
}

TEST_F(CopyJobTest, WhatWasCopiedBeforeAStopIsWhole) {
  for (const std::size_t wanted : {std::size_t{0}, std::size_t{1}, kJobFrames + 1}) {
    CopyJob job = this->job();
    rows_.clear();
    job.document = path("stopped.tcb");
    job.stop = [&] { return rows_.size() == wanted; };
    const CopySummary summary = run_copy(job);
    EXPECT_TRUE(summary.stopped);
    EXPECT_EQ(summary.frames, wanted);
    ASSERT_EQ(std::filesystem::exists(job.document), wanted > 0);
    if (wanted == 0) continue;
    const document::Reader copy = document::Reader::open(job.document);
    EXPECT_TRUE(copy.complete());
    EXPECT_EQ(copy.frame_count(), wanted);
  }
}

TEST_F(CopyJobTest, ADocumentThatHasBecomeShorterIsToldOfAndLeavesNothing) {
  CopyJob job = this->job();
  job.document = path("out.tcb");
  job.plan.frames[2].frame = kJobFrames;
  try {
    run_copy(job);
    ADD_FAILURE() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kInput);
  }
  EXPECT_EQ(dir_.entries(), 0u);
}

}  // namespace
}  // namespace knotreel::pipeline
