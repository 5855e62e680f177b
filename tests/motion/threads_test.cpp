// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <opencv2/core/utility.hpp>

#include "knotreel/base/parallel.h"
#include "knotreel/motion/cut.h"
#include "knotreel/motion/measures.h"
#include "knotreel/motion/refine_motion.h"
#include "knotreel/motion/still.h"
#include "knotreel/motion/warp.h"
#include "motion/scenes.h"

namespace knotreel::motion {
namespace {

using testing::moved_texture;
using testing::with_noise;

/// Everything that the module makes of two pictures.
struct Everything {
  FlowPair pair;
  std::vector<Vec2> motions;
  std::vector<Vec2> refined;
  std::vector<Stillness> still;
  std::vector<float> warped;
  std::vector<double> figures;
};

Everything everything(const image::Image& from, const image::Image& to) {
  const Luma a = luma_of(from);
  const Luma b = luma_of(to);
  Everything all;
  all.pair = find_flow_pair(a, b);
  std::vector<Vec2> points;
  for (int i = 0; i < 500; ++i) points.push_back({i * 0.61, i * 0.37});
  all.motions = point_motion(points, all.pair.forward, all.pair.consistent);
  all.refined = all.motions;
  refine_motion(points, all.refined, a, b);
  all.still = still_points(points, all.motions, a, b, warp(b, all.pair.forward));
  all.warped = warp(to, all.pair.forward).samples;
  FlickerMeter meter;
  meter.add(from, to);
  meter.add(to, from, &all.pair.forward, &all.pair.consistent);
  all.figures = {unlikeness(a, warp(b, all.pair.forward)), meter.flicker(), meter.warped_flicker()};
  return all;
}

TEST(Threads, TheirNumberDoesNotShow) {
  const image::Image from = with_noise(moved_texture(333, 222, {}), 6, 1);
  const image::Image to = with_noise(moved_texture(333, 222, {4.3, -2.6}), 6, 2);
  const auto with_threads = [&](int threads) {
    const ThreadCap cap(threads);
    return everything(from, to);
  };
  const Everything one = with_threads(1);
  for (const int threads : {2, 3}) {
    const Everything more = with_threads(threads);
    EXPECT_EQ(one.pair.forward.xy, more.pair.forward.xy);
    EXPECT_EQ(one.pair.backward.xy, more.pair.backward.xy);
    EXPECT_EQ(one.pair.consistent, more.pair.consistent);
    EXPECT_EQ(one.pair.consistent_back, more.pair.consistent_back);
    EXPECT_EQ(one.motions, more.motions);
    EXPECT_EQ(one.refined, more.refined);
    EXPECT_EQ(one.still, more.still);
    EXPECT_EQ(one.warped, more.warped);
    EXPECT_EQ(one.figures, more.figures);
  }
}

TEST(Threads, ThoseOfOpenCvDoNotShowEither) {
  const Luma from = luma_of(with_noise(moved_texture(333, 222, {}), 6, 1));
  const Luma to = luma_of(with_noise(moved_texture(333, 222, {4.3, -2.6}), 6, 2));
  const int before = cv::getNumThreads();
  for (const FlowOptions::Effort effort :
       {FlowOptions::Effort::kUltrafast, FlowOptions::Effort::kFast, FlowOptions::Effort::kMedium}) {
    cv::setNumThreads(1);
    const Flow one = find_flow(from, to, {effort});
    cv::setNumThreads(2);
    EXPECT_EQ(one.xy, find_flow(from, to, {effort}).xy);
  }
  cv::setNumThreads(before);
}

}  // namespace
}  // namespace knotreel::motion
