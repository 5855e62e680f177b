// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/flow.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "knotreel/base/error.h"
#include "motion/scenes.h"

namespace knotreel::motion {
namespace {

using testing::constant_flow;
using testing::draw;
using testing::moved_texture;
using testing::Texture;

constexpr int kFlowWidth = 192;
constexpr int kFlowHeight = 128;
constexpr int kFlowMargin = 16;  // what comes in at the border cannot be known

/// Median distance, over the pixels away from the border, of a flow from the true one.
template <typename Truth>
double median_error(const Flow& flow, const Truth& truth) {
  std::vector<double> errors;
  for (int y = kFlowMargin; y < flow.height - kFlowMargin; ++y) {
    for (int x = kFlowMargin; x < flow.width - kFlowMargin; ++x) {
      const Vec2 p{x + 0.5, y + 0.5};
      errors.push_back(norm(flow.at(p) - truth(p)));
    }
  }
  return testing::median(errors);
}

double share(const std::vector<std::uint8_t>& mask) {
  return double(std::count(mask.begin(), mask.end(), 1)) / double(mask.size());
}

using Effort = FlowOptions::Effort;

constexpr const char* kEffortNames[] = {"ultrafast", "fast", "medium"};

/// Median errors that are allowed, in pixels: the first two look at a quarter of the size only.
double allowed(Effort effort) {
  if (effort == Effort::kUltrafast) return 0.25;
  return effort == Effort::kFast ? 0.15 : 0.1;
}

class EveryEffort : public ::testing::TestWithParam<Effort> {};

TEST_P(EveryEffort, FindsTranslations) {
  for (const Vec2 d : {Vec2{0, 0}, Vec2{1, 0}, Vec2{0.5, -0.25}, Vec2{-3.3, 2.1}, Vec2{8, -5}}) {
    const Flow flow = find_flow(moved_texture(kFlowWidth, kFlowHeight, {}),
                                moved_texture(kFlowWidth, kFlowHeight, d), {GetParam()});
    EXPECT_LT(median_error(flow, [d](Vec2) { return d; }), allowed(GetParam())) << d.x << ", " << d.y;
  }
}

TEST_P(EveryEffort, FindsARotation) {
  const Texture texture;
  const Vec2 centre{kFlowWidth / 2.0, kFlowHeight / 2.0};
  const double angle = 0.04;
  const auto turned = [&](Vec2 p, double by) {
    const Vec2 d = p - centre;
    return centre + Vec2{std::cos(by) * d.x - std::sin(by) * d.y, std::sin(by) * d.x + std::cos(by) * d.y};
  };
  const auto after = [&](Vec2 p) { return texture(turned(p, -angle)); };
  const Flow flow =
      find_flow(draw(kFlowWidth, kFlowHeight, texture), draw(kFlowWidth, kFlowHeight, after), {GetParam()});
  EXPECT_LT(median_error(flow, [&](Vec2 p) { return turned(p, angle) - p; }), allowed(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Efforts, EveryEffort,
                         ::testing::Values(Effort::kUltrafast, Effort::kFast, Effort::kMedium),
                         [](const auto& test) { return std::string(kEffortNames[int(test.param)]); });

TEST(FindFlow, AnySizeWillDo) {
  for (const auto& [width, height] : {std::pair{1, 1}, {1, 50}, {7, 5}, {31, 33}, {300, 2}}) {
    const Flow flow = find_flow(moved_texture(width, height, {}), moved_texture(width, height, {}));
    EXPECT_EQ(flow.width, width);
    EXPECT_EQ(flow.height, height);
    ASSERT_EQ(flow.xy.size(), std::size_t(2 * width * height));
    for (const float d : flow.xy) EXPECT_NEAR(d, 0, 0.05);
  }
}

TEST(FindFlow, ColourDoesNotMatter) {
  const image::Image from = moved_texture(64, 48, {});
  const image::Image to = moved_texture(64, 48, {1, 1});
  EXPECT_EQ(find_flow(from, to).xy,
            find_flow(image::widen_channels(from, 3), image::widen_channels(to, 3)).xy);
}

TEST(FindFlow, AShapeIsSeenByItsAlphaAlone) {
  const auto black_shape = [](Vec2 d) {
    image::Image picture = image::make_image(96, 64, 2);
    const image::Image alpha = moved_texture(96, 64, d);
    for (std::size_t i = 0; i < alpha.samples.size(); ++i) picture.samples[2 * i + 1] = alpha.samples[i];
    return picture;
  };
  const Flow flow = find_flow(black_shape({}), black_shape({2, -1}));
  EXPECT_LT(median_error(flow, [](Vec2) { return Vec2{2, -1}; }), 0.3);
}

TEST(FindFlow, RefusesPicturesOfDifferentSizes) {
  EXPECT_THROW(find_flow(moved_texture(40, 40, {}), moved_texture(40, 41, {})), Error);
  EXPECT_THROW(find_flow(Luma{}, Luma{}), Error);
}

TEST(FlowAt, IsBilinearBetweenCentresAndConstantBeyond) {
  const Flow flow{2, 2, {0, 0, 4, 0, 0, 8, 4, 8}};
  EXPECT_EQ(flow.at({0.5, 0.5}), (Vec2{0, 0}));
  EXPECT_EQ(flow.at({1.5, 1.5}), (Vec2{4, 8}));
  EXPECT_EQ(flow.at({0.75, 1.25}), (Vec2{1, 6}));
  EXPECT_EQ(flow.at({-9, 99}), (Vec2{0, 8}));
}

TEST(Consistent, AcceptsWhatComesBack) {
  const auto mask = consistent(constant_flow(20, 10, {3, 0}), constant_flow(20, 10, {-3.5, 0}));
  for (int x = 0; x < 20; ++x) EXPECT_EQ(mask[std::size_t(x)], x + 0.5 + 3 <= 20 ? 1 : 0) << x;
}

TEST(Consistent, RejectsWhatDoesNot) {
  EXPECT_EQ(share(consistent(constant_flow(20, 10, {0, 0}), constant_flow(20, 10, {1.01, 0}))), 0);
  EXPECT_EQ(share(consistent(constant_flow(20, 10, {0, 0}), constant_flow(20, 10, {0.99, 0}))), 1);
}

TEST(Consistent, LongerVectorsMayBeOffByMore) {
  const Flow forward = constant_flow(40, 40, {10, 0});
  const Flow backward = constant_flow(40, 40, {-11.4, 0});
  EXPECT_EQ(consistent(forward, backward)[0], 1);
  EXPECT_EQ(consistent(forward, backward, 1.0, 0.0)[0], 0);
}

TEST(Consistent, IsWhatLookingUpEveryPixelOnItsOwnSays) {
  const auto random_flow = [](unsigned seed) {
    Flow flow = testing::constant_flow(67, 41, {});
    std::mt19937 random(seed);
    for (float& v : flow.xy) v = static_cast<float>(random() % 1200) / 100 - 6;
    return flow;
  };
  const Flow there = random_flow(1);
  const Flow back = random_flow(2);
  const std::vector<std::uint8_t> found = consistent(there, back, 3, 0.2);
  int count = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const Vec2 d{double{there.xy[2 * i]}, double{there.xy[2 * i + 1]}};
    const Vec2 p = Vec2{double(i % 67) + 0.5, double(i / 67) + 0.5} + d;
    const double room = 3 + 0.2 * norm(d) - norm(d + back.at(p));
    const bool inside = p.x >= 0 && p.y >= 0 && p.x <= 67 && p.y <= 41;
    if (std::abs(room) > 1e-4) {
      EXPECT_EQ(found[i] != 0, inside && room > 0) << i;
    }
    count += found[i];
  }
  EXPECT_GT(count, 200);
}

TEST(Consistent, RejectsWhatAPatchCovers) {
  // A patch of other texture moves by 12 to the right over a background that stays.
  const Texture background(1);
  const Texture patch(2);
  const auto scene = [&](double left) {
    return draw(kFlowWidth, kFlowHeight, [&](Vec2 p) {
      const bool in = p.x > left && p.x < left + 60 && p.y > 30 && p.y < 100;
      return in ? patch(p - Vec2{left, 0}) : background(p);
    });
  };
  const FlowPair pair = find_flow_pair(luma_of(scene(50)), luma_of(scene(62)));
  const auto mean_in = [&](int left, int right) {
    int sum = 0;
    for (int y = 45; y < 85; ++y) {
      for (int x = left; x < right; ++x) sum += pair.consistent[std::size_t(y * kFlowWidth + x)];
    }
    return double(sum) / (40 * (right - left));
  };
  EXPECT_LT(mean_in(112, 120), 0.25);  // covered by the patch
  EXPECT_GT(mean_in(65, 95), 0.95);    // the patch
  EXPECT_GT(mean_in(140, 180), 0.95);  // background far away
  EXPECT_EQ(pair.consistent, consistent(pair.forward, pair.backward));
  EXPECT_EQ(pair.consistent_back, consistent(pair.backward, pair.forward));
}

TEST(TurnRound, TakesTheExactWayWhereItIsFoundAgain) {
  const Flow exact = constant_flow(20, 10, {-3, 0.5});
  Flow rough = constant_flow(20, 10, {3.25, 0});
  rough.xy[2 * 105] = 9;  // leads astray
  const Flow before = rough;
  const auto mask = turn_round(exact, rough);
  EXPECT_EQ(mask, consistent(before, exact));
  EXPECT_EQ(mask[105], 0);
  EXPECT_EQ(mask[104], 1);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    EXPECT_EQ(rough.xy[2 * i], mask[i] ? 3 : before.xy[2 * i]) << i;
    EXPECT_EQ(rough.xy[2 * i + 1], mask[i] ? -0.5F : 0) << i;
  }
}

TEST(FlowPair, TheWayBackIsAsExactAsTheWayThere) {
  const Texture texture;
  const auto grown = [&](double by) {
    return draw(kFlowWidth, kFlowHeight, [&](Vec2 p) { return texture(by * (p - Vec2{96, 64})); });
  };
  const double growth = 1.05;
  for (const Effort effort : {Effort::kFast, Effort::kMedium}) {
    const FlowPair pair =
        find_flow_pair(luma_of(grown(1)), luma_of(grown(1 / growth)), {effort, /*turn_back=*/true});
    const auto true_back = [&](Vec2 p) { return (1 / growth - 1) * (p - Vec2{96, 64}); };
    const Flow searched = find_flow(grown(1 / growth), grown(1), {effort});
    EXPECT_LT(median_error(pair.backward, true_back), 1.1 * median_error(searched, true_back));
    const Flow rough = find_flow(grown(1 / growth), grown(1), {Effort::kUltrafast});
    EXPECT_LT(median_error(pair.backward, true_back),
              (effort == Effort::kMedium ? 0.8 : 1.1) * median_error(rough, true_back));
    EXPECT_GT(share(pair.consistent_back), 0.85);
  }
}

}  // namespace
}  // namespace knotreel::motion
