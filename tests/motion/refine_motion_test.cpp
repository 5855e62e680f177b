// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/motion/refine_motion.h"

#include <gtest/gtest.h>

#include <random>

#include "knotreel/base/error.h"
#include "motion/scenes.h"

namespace knotreel::motion {
namespace {

using namespace testing;

constexpr int kRefineMotionWidth = 160;
constexpr int kRefineMotionHeight = 120;

/// Points all over a picture and a little beside it.
std::vector<Vec2> points(std::size_t count, unsigned seed = 3) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> x(-3, kRefineMotionWidth + 3);
  std::uniform_real_distribution<double> y(-3, kRefineMotionHeight + 3);
  std::vector<Vec2> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back({x(random), y(random)});
  return result;
}

/// A motion, and up to so much off along either axis.
std::vector<Vec2> near(Vec2 motion, double off, std::size_t count, unsigned seed = 4) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> error(-off, off);
  std::vector<Vec2> result;
  for (std::size_t i = 0; i < count; ++i) result.push_back(motion + Vec2{error(random), error(random)});
  return result;
}

std::vector<double> errors(const std::vector<Vec2>& motions, Vec2 truth) {
  std::vector<double> result;
  for (const Vec2 m : motions) result.push_back(norm(m - truth));
  return result;
}

TEST(RefineMotion, MakesTranslationsExact) {
  for (const Vec2 truth : {Vec2{0.4, -0.3}, Vec2{2.3, -1.6}, Vec2{-6.5, 4.2}}) {
    const Luma from = luma_of(moved_texture(kRefineMotionWidth, kRefineMotionHeight, {}));
    const Luma to =
        luma_of(in_other_light(moved_texture(kRefineMotionWidth, kRefineMotionHeight, truth), 1, 7));
    std::vector<Vec2> at = points(400);
    std::erase_if(at, [](Vec2 p) {
      return p.x < 16 || p.y < 16 || p.x > kRefineMotionWidth - 16 || p.y > kRefineMotionHeight - 16;
    });
    std::vector<Vec2> motions = near(truth, 0.4, at.size());
    const double before = median(errors(motions, truth));
    refine_motion(at, motions, from, to, {.stiffness = 4});
    EXPECT_LT(median(errors(motions, truth)), 0.2 * before) << truth.x;
  }
}

TEST(RefineMotion, IsWhatTheReferenceSays) {
  const Luma from = luma_of(with_noise(moved_texture(kRefineMotionWidth, kRefineMotionHeight, {}), 3, 1));
  const Luma to =
      luma_of(with_noise(moved_texture(kRefineMotionWidth, kRefineMotionHeight, {1.7, -2.2}), 3, 2));
  const std::vector<Vec2> at = points(500);
  const std::vector<Vec2> start = near({1.7, -2.2}, 0.5, at.size());
  for (const RefineMotionOptions& options : {RefineMotionOptions{}, RefineMotionOptions{.steps = 1},
                                             RefineMotionOptions{.stiffness = 40, .most = 0.3}}) {
    std::vector<Vec2> motions = start;
    refine_motion(at, motions, from, to, options);
    std::size_t moved = 0;
    std::size_t different = 0;  // where the last step is hardly any better, rounding decides
    for (std::size_t i = 0; i < at.size(); ++i) {
      const Vec2 expected = refined_motion_reference(at[i], start[i], from, to, options);
      different += norm(motions[i] - expected) > 1e-3 ? 1 : 0;
      moved += norm(motions[i] - start[i]) > 0.05 ? 1 : 0;
      EXPECT_LE(norm(motions[i] - start[i]), options.most + 1e-9);
      EXPECT_LT(norm(motions[i] - expected), 0.05) << i;
    }
    EXPECT_GT(moved, at.size() / 3);
    EXPECT_LT(different, at.size() / 50);
  }
}

TEST(RefineMotion, LeavesWhatTheTextureDoesNotTell) {
  const auto stripes = [](double shift) {
    return luma_of(draw(kRefineMotionWidth, kRefineMotionHeight,
                        [&](Vec2 p) { return 120 + 80 * std::sin(0.5 * (p.x - shift)); }));
  };
  const std::vector<Vec2> at = points(100);
  std::vector<Vec2> motions(at.size(), {0.7, 0.3});
  refine_motion(at, motions, stripes(0), stripes(1));
  std::vector<double> along;
  for (const Vec2 m : motions) {
    EXPECT_NEAR(m.y, 0.3, 1e-6);
    along.push_back(std::abs(m.x - 1));
  }
  EXPECT_LT(median(along), 0.05);

  const Luma flat{kRefineMotionWidth, kRefineMotionHeight,
                  std::vector<std::uint8_t>(std::size_t{kRefineMotionWidth} * kRefineMotionHeight, 80)};
  std::vector<Vec2> still(at.size(), {0.7, 0.3});
  refine_motion(at, still, flat, flat);
  EXPECT_EQ(still, std::vector<Vec2>(at.size(), {0.7, 0.3}));
}

TEST(RefineMotion, LeavesWhatDoesNotMove) {
  const Luma from = luma_of(moved_texture(kRefineMotionWidth, kRefineMotionHeight, {}));
  const Luma to = luma_of(moved_texture(kRefineMotionWidth, kRefineMotionHeight, {0.5, 0.2}));
  const std::vector<Vec2> at = points(50);
  std::vector<Vec2> motions(at.size());
  refine_motion(at, motions, from, to);
  EXPECT_EQ(motions, std::vector<Vec2>(at.size()));
}

TEST(RefineMotion, TakesAnyPointAndTheSmallestPictures) {
  for (const int size : {1, 2, 5, 17}) {
    const Luma from = luma_of(moved_texture(size, size, {}));
    const Luma to = luma_of(moved_texture(size, size, {0.5, 0.2}));
    const std::vector<Vec2> at = {{0, 0}, {0.5, 0.5}, {-40, 3}, {1e4, -1e4}, {double(size), double(size)}};
    std::vector<Vec2> motions(at.size(), {3, -200});
    refine_motion(at, motions, from, to);
    for (const Vec2 m : motions) EXPECT_LE(norm(m - Vec2{3, -200}), 1 + 1e-9);
  }
}

TEST(RefineMotion, RefusesWhatDoesNotFit) {
  const Luma a = luma_of(moved_texture(20, 20, {}));
  const Luma b = luma_of(moved_texture(20, 21, {}));
  const std::vector<Vec2> at(3);
  std::vector<Vec2> motions(3);
  EXPECT_THROW(refine_motion(at, motions, a, b), Error);
  motions.resize(2);
  EXPECT_THROW(refine_motion(at, motions, a, a), Error);
}

}  // namespace
}  // namespace knotreel::motion
