// SPDX-License-Identifier: GPL-3.0-or-later
#include "bench_clips.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "knotreel/base/parallel.h"

namespace knotreel::media {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 36;

double mean_change(const std::string& name, int a, int b) {
  const image::Image one = bench_clip_frame(name, kWidth, kHeight, a);
  const image::Image other = bench_clip_frame(name, kWidth, kHeight, b);
  double sum = 0;
  for (std::size_t i = 0; i < one.samples.size(); ++i) {
    sum += std::abs(double{one.samples[i]} - double{other.samples[i]});
  }
  return sum / double(one.samples.size());
}

/// Share of samples that are equal to the bit.
double share_equal(const std::string& name, int a, int b) {
  const image::Image one = bench_clip_frame(name, kWidth, kHeight, a);
  const image::Image other = bench_clip_frame(name, kWidth, kHeight, b);
  std::size_t equal = 0;
  for (std::size_t i = 0; i < one.samples.size(); ++i) equal += one.samples[i] == other.samples[i];
  return double(equal) / double(one.samples.size());
}

TEST(BenchClips, FramesAreTheSameWheneverDrawn) {
  for (const std::string& name : bench_clip_names()) {
    for (const int frame : {0, 13, 59}) {
      const ThreadCap one(1);
      const auto first = bench_clip_frame(name, kWidth, kHeight, frame).samples;
      const ThreadCap three(3);
      bench_clip_frame(name, kWidth, kHeight, frame + 1);
      EXPECT_EQ(bench_clip_frame(name, kWidth, kHeight, frame).samples, first) << name << ' ' << frame;
    }
  }
}

TEST(BenchClips, SamplesAreInRangeAndVary) {
  for (const std::string& name : bench_clip_names()) {
    const auto samples = bench_clip_frame(name, kWidth, kHeight, 7).samples;
    const auto [least, most] = std::minmax_element(samples.begin(), samples.end());
    EXPECT_GE(*least, 0) << name;
    EXPECT_LE(*most, 255) << name;
    EXPECT_GT(*most - *least, 100) << name;
  }
}

TEST(BenchClips, TheyMoveAsTheirNamesSay) {
  EXPECT_GT(share_equal("static", 10, 11), 0.6);
  EXPECT_GT(mean_change("static", 10, 11), 0);
  EXPECT_LT(share_equal("pan", 10, 11), 0.3);
  EXPECT_LT(share_equal("noise", 10, 11), 0.1);
  // The cut is after twelve frames.
  EXPECT_GT(mean_change("cuts", 11, 12), 5 * mean_change("cuts", 10, 11));
  EXPECT_GT(mean_change("cartoon", 10, 15), 1);
}

}  // namespace
}  // namespace knotreel::media
