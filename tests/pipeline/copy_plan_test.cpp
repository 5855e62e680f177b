// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/pipeline/copy_plan.h"

#include <gtest/gtest.h>

#include "knotreel/base/error.h"
#include "knotreel/base/ticks.h"

namespace knotreel::pipeline {
namespace {

constexpr video::Rational kPictureRate{25, 1};

Contents document_at(std::vector<std::int64_t> times, std::int64_t last_duration,
                     const std::string& source = "a") {
  Contents contents;
  contents.name = source + ".tcb";
  contents.info.width = 64;
  contents.info.height = 48;
  contents.info.time_base_num = 1;
  contents.info.time_base_den = 1000;
  contents.info.metadata["source"] = source;
  contents.steps = {512, 256};
  contents.times = std::move(times);
  contents.last_duration = last_duration;
  return contents;
}

std::vector<std::int64_t> times_of(const CopyPlan& plan) {
  std::vector<std::int64_t> times;
  for (const CopiedFrame& frame : plan.frames) times.push_back(frame.pts);
  return times;
}

using Times = std::vector<std::int64_t>;

TEST(CopyPlan, OneDocumentStaysAsItIs) {
  Contents document = document_at({7, 47, 90}, 40);
  document.info.metadata["start"] = "7";
  document.info.metadata["end"] = "131";
  const CopyPlan plan = plan_copy({document}, kPictureRate);
  EXPECT_EQ(plan.info, document.info);
  EXPECT_EQ(plan.steps, document.steps);
  EXPECT_EQ(times_of(plan), document.times);
  document.last_duration = 0;
  EXPECT_EQ(plan_copy({document}, kPictureRate).info, document.info);
}

TEST(CopyPlan, EachDocumentBeginsWhereTheOneBeforeEnds) {
  const CopyPlan plan = plan_copy(
      {document_at({0, 40, 100}, 30), document_at({500, 540}, 40, "b"), document_at({0}, 20)}, kPictureRate);
  EXPECT_EQ(times_of(plan), (Times{0, 40, 100, 130, 170, 210}));
  EXPECT_EQ(plan.end, 230);
  EXPECT_EQ(plan.info.metadata.at("end"), "230");
  EXPECT_EQ(plan.frames[4].document, 1u);
  EXPECT_EQ(plan.frames[4].frame, 1u);
}

TEST(CopyPlan, WhatOneDocumentWasSplitIntoKeepsItsTimes) {
  EXPECT_EQ(times_of(plan_copy({document_at({5}, 40), document_at({300}, 40), document_at({320}, 40)},
                               kPictureRate)),
            (Times{5, 300, 320}));
  // Twice the same, and another one whose times are later.
  EXPECT_EQ(times_of(plan_copy({document_at({5}, 40), document_at({5}, 40), document_at({300}, 40, "b")},
                               kPictureRate)),
            (Times{5, 45, 85}));
}

TEST(CopyPlan, UnitsOfTimeAreThoseThatAllHave) {
  Contents ntsc = document_at({0, 1, 2}, 1, "b");
  ntsc.info.time_base_num = 1001;
  ntsc.info.time_base_den = 30000;
  const CopyPlan plan = plan_copy({document_at({0, 40}, 40), ntsc}, kPictureRate);
  EXPECT_EQ(plan.info.time_base_num, 1);
  EXPECT_EQ(plan.info.time_base_den, 30000);
  EXPECT_EQ(times_of(plan), (Times{0, 1200, 2400, 3401, 4402}));
  EXPECT_EQ(plan.end, 5403);
}

TEST(CopyPlan, PicturesLastAsLongAsTheRateSays) {
  Contents first = document_at({0}, 0), second = document_at({0}, 0, "b");
  first.info.time_base_den = second.info.time_base_den = 25;
  EXPECT_EQ(times_of(plan_copy({first, second, first}, kPictureRate)), (Times{0, 1, 2}));
  const CopyPlan slow = plan_copy({first, second}, {1, 2});
  EXPECT_EQ(times_of(slow), (Times{0, 50}));
  const CopyPlan fast = plan_copy({first, second}, {60, 1});
  EXPECT_EQ(fast.info.time_base_den, 300);
  EXPECT_EQ(times_of(fast), (Times{0, 5}));
  EXPECT_EQ(fast.end, 10);
}

TEST(CopyPlan, PartsBeginAtZeroAndEndWithTheirLastFrame) {
  Contents document = document_at({10, 50, 100, 130}, 30);
  document.info.metadata["start"] = "10";
  document.info.metadata["end"] = "160";
  const CopyPlan whole = plan_copy({document}, kPictureRate);
  const CopyPlan middle = part_of(whole, 1, 2);
  EXPECT_EQ(times_of(middle), (Times{0, 50}));
  EXPECT_EQ(middle.info.metadata.at("end"), "80");
  EXPECT_FALSE(middle.info.metadata.contains("start"));
  const CopyPlan head = part_of(whole, 0, 1);
  EXPECT_EQ(times_of(head), (Times{10, 50}));
  EXPECT_EQ(head.info.metadata.at("start"), "10");
  EXPECT_EQ(head.info.metadata.at("end"), "100");
  EXPECT_EQ(part_of(whole, 0, 3).info, whole.info);
}

TEST(CopyPlan, MetadataIsWhatAllSay) {
  Contents first = document_at({0}, 40), second = document_at({0}, 40, "b");
  first.info.metadata["frame_rate"] = second.info.metadata["frame_rate"] = "25/1";
  first.info.metadata["pixel_format"] = "yuv420p";
  first.info.metadata["colour_tags"] = "1 6 6 6 1";
  second.info.metadata["title"] = "two";
  const CopyPlan plan = plan_copy({first, second}, kPictureRate);
  EXPECT_EQ(plan.info.metadata, (std::map<std::string, std::string>{
                                    {"frame_rate", "25/1"}, {"colour_tags", "1 6 6 6 1"}, {"end", "80"}}));
  ASSERT_EQ(plan.warnings.size(), 1u);
  EXPECT_NE(plan.warnings[0].find("b.tcb"), std::string::npos);
}

TEST(CopyPlan, TheRateIsToldWhereAllFramesLastAsLong) {
  const auto rate_of = [](const std::vector<Contents>& documents, video::Rational rate = kPictureRate) {
    const CopyPlan plan = plan_copy(documents, rate);
    const auto found = plan.info.metadata.find("frame_rate");
    return found == plan.info.metadata.end() ? std::string() : found->second;
  };
  const Contents still = document_at({0}, 0);
  EXPECT_EQ(rate_of({still, still, still}), "25/1");
  EXPECT_EQ(rate_of({still, still}, {30000, 1001}), "30000/1001");
  EXPECT_EQ(rate_of({still}), "") << "one that stays as it is";
  EXPECT_EQ(rate_of({still, document_at({0, 40}, 40)}), "25/1");
  EXPECT_EQ(rate_of({still, document_at({0, 40}, 50)}), "");
  EXPECT_EQ(rate_of({still, document_at({0, 50}, 40)}), "");
  Contents first = document_at({0}, 40), second = document_at({0}, 40, "b");
  first.info.metadata["frame_rate"] = second.info.metadata["frame_rate"] = "24/1";
  EXPECT_EQ(rate_of({first, second}), "24/1") << "what all say";
  first.info.metadata["frame_rate"] = "23/1";
  EXPECT_EQ(rate_of({first, second}), "25/1");
}

TEST(CopyPlan, StepsAreTheLargestThatAllHave) {
  Contents first = document_at({0}, 40), second = document_at({0}, 40, "b");
  second.steps = {768, 64};
  EXPECT_EQ(plan_copy({first, second}, kPictureRate).steps, (document::Steps{256, 64}));
}

TEST(CopyPlan, WhatCannotBeOneDocumentIsRefusedByName) {
  const Contents first = document_at({0}, 40);
  const auto refused = [&](const Contents& second) {
    try {
      plan_copy({first, second}, kPictureRate);
      ADD_FAILURE() << "not refused";
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::kInvalidArgument);
      return std::string(e.what());
    }
    return std::string();
  };
  Contents second = document_at({0}, 40, "b");
  second.info.width = 65;
  EXPECT_NE(refused(second).find("'b.tcb' and 'a.tcb'"), std::string::npos);
  second = document_at({0}, 40, "b");
  second.info.channels = 1;
  EXPECT_NE(refused(second).find("channels"), std::string::npos);
  second = document_at({0}, 40, "b");
  second.info.degree = 3;
  EXPECT_NE(refused(second).find("degrees"), std::string::npos);
  second = document_at({0}, 40, "b");
  second.info.metadata["display_matrix"] = "00";
  EXPECT_NE(refused(second).find("display_matrix"), std::string::npos);
  second = document_at({0}, 40, "b");
  second.info.time_base_den = 2147483647;
  EXPECT_NE(refused(second).find("units of time"), std::string::npos);
  second = document_at({kMaxTicks}, 40, "b");
  second.info.time_base_den = 7;
  EXPECT_NE(refused(second).find("times are too large"), std::string::npos);
}

}  // namespace
}  // namespace knotreel::pipeline
