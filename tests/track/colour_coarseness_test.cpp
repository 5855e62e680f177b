// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/colour_coarseness.h"

#include <gtest/gtest.h>

#include <limits>

namespace knotreel::track {
namespace {

TEST(ColourCoarseness, GroupsBeginAsTheirFirstFrameSays) {
  ColourCoarseness coarseness;
  coarseness.start_group(std::numeric_limits<double>::infinity());
  EXPECT_LT(coarseness.factor(), 1);
  coarseness.start_group(38);
  EXPECT_EQ(coarseness.factor(), 1);
  coarseness.start_group(20);
  EXPECT_GT(coarseness.factor(), 1);
  coarseness.start_group(26.5);
  EXPECT_EQ(coarseness.factor(), 1);
}

TEST(ColourCoarseness, ChangesWithThePicturesButNotToAndFro) {
  ColourCoarseness coarseness;
  coarseness.start_group(40);
  for (const double psnr : {38.0, 39.0, 37.6, 38.4}) {
    coarseness.end_frame(psnr);
    EXPECT_LT(coarseness.factor(), 1) << psnr;
  }
  coarseness.end_frame(37.4);
  for (const double psnr : {38.0, 38.4, 30.0, 26.1}) {
    EXPECT_EQ(coarseness.factor(), 1) << psnr;
    coarseness.end_frame(psnr);
  }
  coarseness.end_frame(25.9);
  for (const double psnr : {26.1, 26.9, 24.0}) {
    EXPECT_GT(coarseness.factor(), 1) << psnr;
    coarseness.end_frame(psnr);
  }
  coarseness.end_frame(27.1);
  EXPECT_EQ(coarseness.factor(), 1);
}

TEST(ColourCoarseness, WhatIsLeftIsLeftHoweverFarTheFallOrRise) {
  ColourCoarseness coarseness;
  coarseness.start_group(40);
  coarseness.end_frame(26.5);  // where those that come from coarse colours keep them
  EXPECT_EQ(coarseness.factor(), 1);
  coarseness.start_group(20);
  coarseness.end_frame(38);  // where those that come from fine colours keep them
  EXPECT_EQ(coarseness.factor(), 1);
}

}  // namespace
}  // namespace knotreel::track
