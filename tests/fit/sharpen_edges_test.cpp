// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/sharpen_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "support/pictures.h"

namespace knotreel::fit {
namespace {

constexpr double kSoftness = 0.12;

/// Two flat sides of a slanted edge, and the pixels that it crosses.
struct Scene {
  image::Image sharp = image::make_image(24, 20, 3);
  image::Image soft = sharp;
  std::vector<std::uint8_t> crossed = std::vector<std::uint8_t>(24 * 20, 0);

  Scene() {
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 24; ++x) {
        const double across = x + 0.5 - 12 + 0.4 * (y + 0.5 - 10);
        crossed[static_cast<std::size_t>(y * 24 + x)] = std::abs(across) < 0.7;
        for (int c = 0; c < 3; ++c)
          sharp.at(x, y, c) =
              static_cast<float>(40 + 50 * c + 100 * std::clamp(across / 1.4 + 0.5, 0.0, 1.0));
      }
    }
    soft = test::softened(sharp, kSoftness);
  }

  bool is_crossed(int x, int y) const { return crossed[static_cast<std::size_t>(y * 24 + x)]; }
  bool is_beside(int x, int y) const {
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, 19); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, 23); ++u)
        if (is_crossed(u, v)) return !is_crossed(x, y);
    return false;
  }
};

TEST(SharpenEdges, BringsThePixelsBesideThemCloserToTheSharpPicture) {
  const Scene scene;
  image::Image picture = scene.soft;
  sharpen_edges(picture, scene.crossed, kSoftness);
  double before = 0;
  double after = 0;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 24; ++x) {
      for (int c = 0; c < 3; ++c) {
        if (!scene.is_beside(x, y)) {
          EXPECT_EQ(picture.at(x, y, c), scene.soft.at(x, y, c)) << x << ' ' << y;
          continue;
        }
        before += std::abs(static_cast<double>(scene.soft.at(x, y, c) - scene.sharp.at(x, y, c)));
        after += std::abs(static_cast<double>(picture.at(x, y, c) - scene.sharp.at(x, y, c)));
      }
    }
  }
  EXPECT_LT(after, 0.5 * before);
}

TEST(SharpenEdges, LeavesPicturesWithHardOrWithoutEdgesAlone) {
  const Scene scene;
  image::Image picture = scene.soft;
  sharpen_edges(picture, scene.crossed, 0);
  EXPECT_EQ(picture.samples, scene.soft.samples);
  sharpen_edges(picture, std::vector<std::uint8_t>(24 * 20, 0), kSoftness);
  EXPECT_EQ(picture.samples, scene.soft.samples);
}

TEST(SharpenEdges, InvisibleColoursDoNotBleed) {
  // Opaque and flat at the left of the edge, transparent with a colour of no meaning at the right.
  const Scene scene;
  image::Image picture = image::make_image(24, 20, 4);
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 24; ++x) {
      const float alpha = (scene.soft.at(x, y, 0) - 40) * 2.55F;
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = alpha < 255 ? 900.0F : 40.0F;
      picture.at(x, y, 3) = alpha;
    }
  }
  const image::Image before = picture;
  sharpen_edges(picture, scene.crossed, kSoftness);
  int changed = 0;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 24; ++x) {
      for (int c = 0; c < 3; ++c) EXPECT_EQ(picture.at(x, y, c), before.at(x, y, c)) << x << ' ' << y;
      changed += picture.at(x, y, 3) != before.at(x, y, 3);
    }
  }
  EXPECT_GT(changed, 20) << "alpha has an edge, too";
}

}  // namespace
}  // namespace knotreel::fit
