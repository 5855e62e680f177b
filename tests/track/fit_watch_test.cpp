// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/fit_watch.h"

#include <gtest/gtest.h>

namespace knotreel::track {
namespace {

const TrackOptions kOptions{
    .drift = 3, .look_interval = 8, .repair_below = 0.4, .repair_patience = 5, .mend_below = 0.3};

FitWatch watch(double psnr) {
  FitWatch watch(kOptions);
  watch.start_group(psnr, Start::kFirst, false);
  return watch;
}

TEST(FitWatch, WhatFallsIsRepairedAndWhatFallsLessIsMended) {
  const FitWatch w = watch(30);
  EXPECT_TRUE(w.needs_repair(29.5));
  EXPECT_FALSE(w.needs_repair(29.65));
  EXPECT_TRUE(w.needs_mending(29.65, false));
  EXPECT_FALSE(w.needs_mending(29.65, true));
  EXPECT_FALSE(w.needs_mending(29.75, false));
  EXPECT_FALSE(w.needs_repair(31));
}

TEST(FitWatch, TheMoreRepairsTheDeeperAFall) {
  FitWatch w = watch(30);
  EXPECT_TRUE(w.needs_repair(29.3));
  w.end_frame(30, true);  // a fifth of the frames of late: twice as deep
  EXPECT_FALSE(w.needs_repair(29.3));
  EXPECT_TRUE(w.needs_repair(29.1));
  for (int i = 0; i < 20; ++i) w.end_frame(30, false);
  EXPECT_TRUE(w.needs_repair(29.5));
}

TEST(FitWatch, WhatHasDriftedIsRepairedHoweverOftenThatWas) {
  FitWatch w = watch(32);
  for (int i = 0; i < 30; ++i) w.end_frame(29.5, true);
  EXPECT_TRUE(w.has_fallen(29.05));
  EXPECT_FALSE(w.needs_repair(29.05));  // 2.95 below the start
  EXPECT_TRUE(w.needs_repair(28.95));
}

TEST(FitWatch, LooksComeAfterSoManyFramesOrAFall) {
  FitWatch w = watch(30);
  for (int i = 1; i < 8; ++i) EXPECT_FALSE(w.is_time_to_look(30)) << i;
  EXPECT_TRUE(w.is_time_to_look(30));
  w.looked(30);
  EXPECT_FALSE(w.is_time_to_look(27.1));
  EXPECT_TRUE(w.is_time_to_look(26.9));
}

TEST(FitWatch, ColdFramesInVainMakeLooksWait) {
  FitWatch w = watch(30);
  w.made_cold_frame_in_vain();
  EXPECT_TRUE(w.is_time_to_look(26.9));
  w.made_cold_frame_in_vain();
  w.looked(30);
  EXPECT_FALSE(w.is_time_to_look(26.9));  // twice as deep, or as long
  EXPECT_TRUE(w.is_time_to_look(23.9));
  w.looked(30);
  for (int i = 1; i < 16; ++i) EXPECT_FALSE(w.is_time_to_look(30)) << i;
  EXPECT_TRUE(w.is_time_to_look(30));
  w.start_group(30, Start::kDrift, false);
  EXPECT_TRUE(w.is_time_to_look(26.9));
}

TEST(FitWatch, GroupsThatDidNotLastMakeLooksWait) {
  FitWatch w = watch(30);
  const auto frames = [&](int count) {
    for (int i = 0; i < count; ++i) w.end_frame(30, false);
  };
  const auto looks_at = [&](double psnr) {
    FitWatch now = w;
    return now.is_time_to_look(psnr);
  };
  frames(3);
  w.start_group(30, Start::kDrift, true);
  frames(2);
  EXPECT_TRUE(looks_at(26.9)) << "one short group is none";
  w.start_group(30, Start::kDrift, true);
  EXPECT_FALSE(looks_at(26.9)) << "two in a row";
  EXPECT_TRUE(looks_at(23.9));
  frames(2);
  w.start_group(30, Start::kDrift, true);
  EXPECT_FALSE(looks_at(23.9)) << "three";
  frames(2);
  FitWatch cut = w;
  cut.start_group(30, Start::kCut, true);
  EXPECT_TRUE(cut.is_time_to_look(26.9)) << "of another scene";
  frames(4);
  w.start_group(30, Start::kDrift, true);
  EXPECT_TRUE(looks_at(26.9)) << "that one lasted";
}

TEST(FitWatch, GroupsThatAreCheapMakeLooksWaitHalfAsLong) {
  FitWatch w = watch(30);
  const auto look_after_groups = [&](int count, double psnr) {
    for (int i = 0; i < count; ++i) w.start_group(30, Start::kDrift, false);
    FitWatch now = w;
    return now.is_time_to_look(psnr);
  };
  EXPECT_TRUE(look_after_groups(3, 26.9)) << "as if one had been made in vain";
  EXPECT_FALSE(look_after_groups(1, 26.9)) << "two";
  EXPECT_TRUE(look_after_groups(0, 23.9));
  EXPECT_TRUE(look_after_groups(1, 23.9)) << "five groups, still two";
  EXPECT_FALSE(look_after_groups(1, 23.9)) << "three";
  for (int i = 0; i < 3; ++i) w.end_frame(30, false);
  EXPECT_TRUE(look_after_groups(1, 26.9)) << "three frames are enough";
}

TEST(FitWatch, GroupsThatAreHeldAreNotShort) {
  FitWatch held = watch(30), changing = watch(30);
  for (int group = 0; group < 12; ++group) {
    for (FitWatch* w : {&held, &changing}) w->end_frame(22, false);
    for (int i = 0; i < 50; ++i) held.end_repeated_frame();
    held.start_group(30, Start::kDrift, false);
    changing.start_group(30, Start::kDrift, false);
  }
  EXPECT_TRUE(held.is_time_to_look(22));
  EXPECT_FALSE(changing.is_time_to_look(22));
}

TEST(FitWatch, PicturesAreHeldOnceTheyHaveBeenTheSameForSomeFrames) {
  FitWatch w = watch(30);
  const auto held_after = [&] {
    std::vector<int> frames;
    for (int i = 1; i <= 12; ++i) {
      w.end_repeated_frame();
      if (w.is_held()) frames.push_back(i);
    }
    return frames;
  };
  const std::vector<int> once = held_after();
  ASSERT_EQ(once.size(), 1U) << "a look for each time";
  EXPECT_GT(once.front(), 3) << "animations show a picture for up to four frames";
  w.end_frame(30, false);
  EXPECT_EQ(held_after(), once);
  w.start_group(30, Start::kCut, false);
  EXPECT_EQ(held_after(), once);
}

}  // namespace
}  // namespace knotreel::track
