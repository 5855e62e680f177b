// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "features/chain_defects.h"
#include "features/drawings.h"
#include "features/extract.h"
#include "knotreel/base/parallel.h"
#include "knotreel/features/detect.h"
#include "knotreel/features/fair.h"
#include "knotreel/image/read_image.h"
#include "support/pictures.h"

namespace knotreel::features {
namespace {

using testing::pixels_of;
using testing::Turn;
using testing::turned;

DetectOptions everything() {
  DetectOptions options;
  options.edge_threshold = 1;
  options.anchor_threshold = 1;
  options.min_length = 3;
  options.min_weight = 0;
  options.max_blur = 0;
  options.smoothing = 0.6;
  return options;
}

/// Noise of several sizes of grain.
image::Image noise(int width, int height, int channels, unsigned seed, int grain) {
  const image::Image coarse = test::random_picture(width / grain + 1, height / grain + 1, channels, seed);
  image::Image image = image::make_image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) image.at(x, y, c) = coarse.at(x / grain, y / grain, c);
    }
  }
  return image;
}

void expect_sound(const image::Image& image, const DetectOptions& options) {
  FeatureChains chains = detect_features(image, options);
  const auto defect = find_defect(chains);
  EXPECT_FALSE(defect) << *defect;
  for (const Chain& chain : chains.chains) {
    for (std::size_t i = 1; i + 1 < chain.points.size(); ++i) {
      const ChainPoint& p = chain.points[i];
      const bool at_side = p.x == 0 || p.y == 0 || p.x == image.width - 1 || p.y == image.height - 1;
      EXPECT_FALSE(at_side) << "only ends may lie there";
    }
  }
  fair_chains(chains);
  const auto defect_after = find_defect(chains);
  EXPECT_FALSE(defect_after) << "after fairing: " << *defect_after;
}

TEST(DetectLaws, NoiseOfAnySizeGivesSoundChains) {
  std::size_t points = 0;
  for (unsigned seed = 0; seed < 120; ++seed) {
    const int width = 4 + int(seed * 7 % 83);
    const int height = 4 + int(seed * 13 % 71);
    const int channels = 1 + int(seed % 4);
    const image::Image image = noise(width, height, channels, seed, 1 + int(seed % 5));
    SCOPED_TRACE(::testing::Message() << width << "x" << height << " seed " << seed);
    expect_sound(image, everything());
    expect_sound(image, {});
    points += testing::point_count(detect_features(image, everything()));
  }
  EXPECT_GT(points, 20000U) << "the test is about chains";
}

TEST(DetectLaws, ALargeNoisyPictureGivesSoundChains) {
  for (const int grain : {1, 4}) {
    const image::Image image = noise(300, 260, 3, 5, grain);
    expect_sound(image, everything());
    expect_sound(image, {});
  }
}

TEST(DetectLaws, ThePicturesOfTheRepositoryGiveSoundChains) {
  int pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(KNOTREEL_MEDIA_DIR)) {
    if (entry.path().extension() != ".png") continue;
    ++pictures;
    SCOPED_TRACE(entry.path());
    const image::Image image = image::read_image(entry.path());
    expect_sound(image, {});
    expect_sound(image, everything());
  }
  EXPECT_GT(pictures, 0);
}

TEST(DetectLaws, ChainsAreAsLongAndHeavyAsAsked) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    const FeatureChains chains = detect_features(noise(120, 100, 1, seed, 3));
    const auto arms = testing::arms_of_nodes(chains);
    for (const Chain& chain : chains.chains) {
      const bool link = !chain.closed && arms.at(chain.first_node) > 1 && arms.at(chain.last_node) > 1;
      if (!link) {
        EXPECT_GE(double(chain.points.size()), DetectOptions{}.min_length)
            << (chain.closed ? "closed" : "open") << " at " << chain.points[0].x << ", " << chain.points[0].y;
      }
      EXPECT_GE(chain.points.size(), 4U) << "even links have room for a straight piece";
    }
  }
}

TEST(DetectLaws, AMirroredPictureHasMirroredChains) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    // No two samples are equal, so there are no ties, and sums are mirrored to the last bit.
    const image::Image image = noise(90, 70, 1 + int(seed % 4), seed, 1);
    DetectOptions options = everything();
    options.min_length = 10;
    const auto pixels = pixels_of(detect_features(image, options));
    ASSERT_FALSE(pixels.empty());
    for (const Turn turn : {Turn::kMirrorX, Turn::kMirrorY}) {
      std::size_t same = 0;
      const auto mirrored = pixels_of(detect_features(turned(image, turn), options));
      for (const auto& [x, y] : mirrored) {
        same += pixels.count(turn == Turn::kMirrorX ? std::pair(89 - x, y) : std::pair(x, 69 - y));
      }
      // In white noise one join that goes the other way (equal distances go by position) sends others astray.
      EXPECT_GT(double(same), 0.85 * double(std::max(pixels.size(), mirrored.size())));
    }
  }
}

TEST(DetectLaws, ATransposedPictureHasTransposedChains) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    const image::Image image = noise(90, 70, 1, seed, 1);
    DetectOptions options = everything();
    options.min_length = 10;
    const auto pixels = pixels_of(detect_features(image, options));
    const auto transposed = pixels_of(detect_features(turned(image, Turn::kTranspose), options));
    std::size_t same = 0;
    for (const auto& [x, y] : transposed) same += pixels.count({y, x});
    // Sums are rounded otherwise, and see above.
    EXPECT_GT(double(same), 0.8 * double(std::max(pixels.size(), transposed.size())));
  }
}

TEST(DetectLaws, APictureTurnedHasItsChainsTurned) {
  const image::Image image = image::read_image(KNOTREEL_MEDIA_DIR "/still-life.png");
  const auto pixels = pixels_of(detect_features(image));
  for (const Turn turn : {Turn::kMirrorX, Turn::kMirrorY, Turn::kTranspose}) {
    // Samples of eight bits have many ties, each of which may move a chain by one pixel.
    std::size_t near = 0;
    const auto found = pixels_of(detect_features(turned(image, turn)));
    for (const auto& [x, y] : found) {
      const int back_x = turn == Turn::kTranspose ? y : turn == Turn::kMirrorX ? image.width - 1 - x : x;
      const int back_y = turn == Turn::kTranspose ? x : turn == Turn::kMirrorY ? image.height - 1 - y : y;
      bool any = false;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) any = any || pixels.count({back_x + dx, back_y + dy}) != 0;
      }
      near += any ? 1 : 0;
    }
    EXPECT_GT(double(near), 0.95 * double(found.size()));
    EXPECT_NEAR(double(found.size()), double(pixels.size()), 0.05 * double(pixels.size()));
  }
}

TEST(DetectLaws, AMirroredStepIsAtTheMirroredPlace) {
  // Here everything is a tie: pixels may be one aside, positions not.
  const auto image = testing::disc(60, 30.25, 29.5, 17);
  const FeatureChains chains = detect_features(image);
  const FeatureChains mirrored = detect_features(turned(image, Turn::kMirrorX));
  ASSERT_EQ(chains.chains.size(), 1U);
  ASSERT_EQ(mirrored.chains.size(), 1U);
  for (const ChainPoint& p : mirrored.chains[0].points) {
    double nearest = 100;
    const Vec2 q{60 - p.position.x, p.position.y};
    for (const ChainPoint& r : chains.chains[0].points) nearest = std::min(nearest, norm(r.position - q));
    EXPECT_LT(nearest, 0.75) << "half a step along the curve, and a little across";
  }
}

TEST(DetectLaws, BrightnessUpsideDownIsTheSame) {
  image::Image image = noise(90, 70, 3, 3, 2);
  const auto pixels = pixels_of(detect_features(image));
  for (float& sample : image.samples) sample = 256 - sample;  // exact
  const auto negative = pixels_of(detect_features(image));
  std::size_t same = 0;
  for (const auto& pixel : negative) same += pixels.count(pixel);
  EXPECT_GT(double(same), 0.97 * double(std::max(pixels.size(), negative.size())));
}

TEST(DetectLaws, TheNumberOfThreadsDoesNotShow) {
  const image::Image image = noise(200, 300, 3, 9, 2);
  const auto run = [&](int threads) {
    const ThreadCap cap(threads);
    FeatureChains chains = detect_features(image, everything());
    fair_chains(chains);
    return chains;
  };
  const FeatureChains one = run(1);
  const FeatureChains two = run(2);
  ASSERT_EQ(one.chains.size(), two.chains.size());
  for (std::size_t c = 0; c < one.chains.size(); ++c) {
    ASSERT_EQ(one.chains[c].points.size(), two.chains[c].points.size());
    for (std::size_t i = 0; i < one.chains[c].points.size(); ++i) {
      EXPECT_EQ(one.chains[c].points[i].position, two.chains[c].points[i].position);
    }
  }
}

}  // namespace
}  // namespace knotreel::features
