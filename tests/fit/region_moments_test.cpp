#include "fit/region_moments.h"

#include <gtest/gtest.h>

#include <random>

namespace knotreel::fit {
namespace {

constexpr int kWidth = 37;
constexpr int kHeight = 23;
constexpr double kCell = 2;  // pixels of a picture made smaller
constexpr Vec2 kOrigin{31.5, 17.25};

std::vector<std::vector<float>> random_channels(std::size_t n) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> level(-40, 40);
  std::vector<std::vector<float>> channels(n, std::vector<float>(kWidth * kHeight));
  for (auto& channel : channels) {
    for (float& v : channel) v = level(random);
  }
  return channels;
}

Plane random_plane(std::mt19937& random) {
  std::uniform_real_distribution<double> any(-1, 1);
  return {20 * any(random), any(random), any(random)};
}

double at(const Plane& p, Vec2 u) {
  return p.c + p.x * u.x + p.y * u.y;
}

Vec2 centre(int x, int y) {
  return Vec2{(x + 0.5) * kCell, (y + 0.5) * kCell} - kOrigin;
}

Moments sum_of(const Region& region, const std::vector<std::vector<float>>& channels) {
  Moments m;
  const RunningSums sums(channels, kWidth, 0, kHeight, kCell);
  for (int y = 0; y < kHeight; ++y) region.add_row(sums.row(y), (y + 0.5) * kCell - kOrigin.y, m);
  return m;
}

TEST(RegionMoments, AreSumsOverThePixelsInside) {
  const auto channels = random_channels(3);
  std::mt19937 random(6);
  for (int round = 0; round < 50; ++round) {
    const std::array<Plane, 3> planes{random_plane(random), random_plane(random), random_plane(random)};
    Region region(3, kWidth - 4, kCell, kOrigin);
    for (const Plane& p : planes) region.cut(p);
    const Moments m = sum_of(region, channels);
    for (std::size_t c = 0; c < 4; ++c) {
      std::array<double, 6> expected{};
      for (int y = 0; c < 3 && y < kHeight; ++y) {
        for (int x = 3; x < kWidth - 4; ++x) {
          const Vec2 u = centre(x, y);
          if (!(at(planes[0], u) > 0 && at(planes[1], u) > 0 && at(planes[2], u) > 0)) continue;
          const double q = static_cast<double>(channels[c][std::size_t(y * kWidth + x)]);
          const double products[] = {q, q * u.x, q * u.y, q * u.x * u.x, q * u.x * u.y, q * u.y * u.y};
          for (std::size_t i = 0; i < 6; ++i) expected[i] += products[i];
        }
      }
      const double found[] = {m.one[c], m.x[c], m.y[c], m.xx[c], m.xy[c], m.yy[c]};
      for (std::size_t i = 0; i < 6; ++i)
        EXPECT_NEAR(found[i], expected[i], 1e-6) << round << " " << c << " " << i;
    }
  }
}

/// Lines through pixel centres, level, upright and slanted ones.
TEST(RegionMoments, BothSidesOfALineShareNoPixelAndLeaveNoneOut) {
  const std::vector<std::vector<float>> ones(1, std::vector<float>(kWidth * kHeight, 1.0F));
  const Vec2 through = centre(11, 7);
  for (const Vec2 normal : {Vec2{1, 0}, Vec2{0, 1}, Vec2{1, 1}, Vec2{-1, 2}, Vec2{1.0 / 3, -1.0 / 7}}) {
    const Plane plane{-dot(normal, through), normal.x, normal.y};
    Region above(0, kWidth, kCell, kOrigin);
    above.cut(plane);
    Region below(0, kWidth, kCell, kOrigin);
    below.cut({-plane.c, -plane.x, -plane.y});
    EXPECT_EQ(sum_of(above, ones).one[0] + sum_of(below, ones).one[0], kWidth * kHeight)
        << normal.x << " " << normal.y;
  }
}

TEST(RegionMoments, BandsDoNotMatter) {
  const auto channels = random_channels(1);
  const RunningSums all(channels, kWidth, 0, kHeight, kCell);
  const RunningSums band(channels, kWidth, 9, 12, kCell);
  for (int y = 9; y < 12; ++y) {
    for (int x = 0; x <= kWidth; ++x) {
      EXPECT_EQ(band.row(y)[x].one, all.row(y)[x].one);
      EXPECT_EQ(band.row(y)[x].xx, all.row(y)[x].xx);
    }
  }
}

}  // namespace
}  // namespace knotreel::fit
