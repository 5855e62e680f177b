// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/temporal_target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace knotreel::track {
namespace {

constexpr int kTemporalTargetWidth = 37;
constexpr int kTemporalTargetHeight = 21;
constexpr std::uint64_t kSeed = 20261125;

struct Case {
  image::Image picture = image::make_image(kTemporalTargetWidth, kTemporalTargetHeight, 3);
  std::vector<float> residual;
  std::vector<float> weights;
  Motion motion;

  explicit Case(Vec2 backward) {
    std::mt19937_64 random(kSeed);
    std::normal_distribution<float> level(0, 40);
    std::cauchy_distribution<float> error(0, 2);  // a few are far off
    for (float& s : picture.samples) s = 128 + level(random);
    residual.resize(picture.samples.size());
    for (float& r : residual) r = error(random);
    weights.assign(picture.pixel_count(), 1.0F);
    for (std::size_t i = 3; i < weights.size(); i += 11) weights[i] = 0.25F;
    motion.flow.backward = {kTemporalTargetWidth, kTemporalTargetHeight,
                            std::vector<float>(2 * picture.pixel_count())};
    for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
      motion.flow.backward.xy[2 * i] = static_cast<float>(backward.x);
      motion.flow.backward.xy[2 * i + 1] = static_cast<float>(backward.y);
    }
    motion.flow.consistent_back.assign(picture.pixel_count(), 1);
    for (std::size_t i = 5; i < picture.pixel_count(); i += 13) motion.flow.consistent_back[i] = 0;
  }
  image::Image target(double share) const {
    return temporal_target(picture, residual, weights, motion, share);
  }
};

TEST(TemporalTarget, WithoutAShareIsThePicture) {
  EXPECT_EQ(Case({0, 0}).target(0).samples, Case({0, 0}).picture.samples);
}

TEST(TemporalTarget, TilesThatAreAskedForAreAsIfAllWere) {
  constexpr std::size_t kColumns = (kTemporalTargetWidth + 7) / 8;
  std::vector<std::uint8_t> tiles(kColumns * ((kTemporalTargetHeight + 7) / 8));
  for (std::size_t t = 0; t < tiles.size(); ++t) tiles[t] = t % 3 > 0 ? 1 : 0;
  for (const Vec2 motion : {Vec2{0.1, 0.1}, Vec2{3, -2}}) {
    const Case c(motion);
    const image::Image all = c.target(0.5);
    const image::Image some = temporal_target(c.picture, c.residual, c.weights, c.motion, 0.5, tiles);
    for (int y = 0; y < kTemporalTargetHeight; ++y) {
      for (int x = 0; x < kTemporalTargetWidth; ++x) {
        if (!tiles[std::size_t(y / 8) * kColumns + std::size_t(x / 8)]) continue;
        for (int k = 0; k < 3; ++k) ASSERT_EQ(some.at(x, y, k), all.at(x, y, k)) << x << ", " << y;
      }
    }
  }
}

TEST(TemporalTarget, WhereNothingMovesTheShareCountsTwiceButNotOfOutliers) {
  const Case c({0.1, -0.2});
  constexpr double kShare = 0.3;
  const image::Image target = c.target(kShare);
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < c.residual.size(); ++i) {
    if (c.weights[i / 3] != 1.0F) continue;
    sum += std::abs(static_cast<double>(c.residual[i]));
    ++count;
  }
  const double limit = 6 * sum / count;
  int beyond = 0;
  for (std::size_t i = 0; i < c.residual.size(); ++i) {
    const bool taken = c.weights[i / 3] == 1.0F && c.motion.flow.consistent_back[i / 3] != 0;
    const double missed = std::clamp(static_cast<double>(c.residual[i]), -limit, limit);
    const double off = taken ? (1 - 0.7 * 0.7) * missed : 0;
    EXPECT_NEAR(target.samples[i], static_cast<double>(c.picture.samples[i]) - off, 1e-2) << i;
    beyond += taken && std::abs(static_cast<double>(c.residual[i])) > limit ? 1 : 0;
  }
  EXPECT_GT(beyond, 10);
}

TEST(TemporalTarget, AlongTheMotionTheResidualIsInterpolated) {
  const Case c({-1.75, 0.5});
  const image::Image target = c.target(0.4);
  int taken = 0;
  for (int y = 0; y + 1 < kTemporalTargetHeight; ++y) {
    for (int x = 2; x < kTemporalTargetWidth; ++x) {
      const auto pixel = static_cast<std::size_t>(y * kTemporalTargetWidth + x);
      const auto above = static_cast<std::size_t>(y * kTemporalTargetWidth + x - 2);
      const std::size_t below = above + kTemporalTargetWidth;
      const bool ordinary = c.weights[above] == 1.0F && c.weights[above + 1] == 1.0F &&
                            c.weights[below] == 1.0F && c.weights[below + 1] == 1.0F;
      const bool is_taken = ordinary && c.motion.flow.consistent_back[pixel] != 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto row = [&](std::size_t left) {
          return 0.75 * static_cast<double>(c.residual[3 * left + k]) +
                 0.25 * static_cast<double>(c.residual[3 * (left + 1) + k]);
        };
        const double off = is_taken ? 0.4 * (row(above) + row(below)) / 2 : 0;
        EXPECT_NEAR(target.samples[3 * pixel + k],
                    static_cast<double>(c.picture.samples[3 * pixel + k]) - off, 1e-3);
      }
      taken += is_taken ? 1 : 0;
    }
  }
  EXPECT_GT(taken, 300);
}

/// A surface that misses nothing is asked for the picture.
TEST(TemporalTarget, OfNoResidualIsThePicture) {
  Case c({0, 0});
  std::fill(c.residual.begin(), c.residual.end(), 0.0F);
  EXPECT_EQ(c.target(0.9).samples, c.picture.samples);
}

}  // namespace
}  // namespace knotreel::track
