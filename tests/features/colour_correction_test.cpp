// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/colour_correction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "features/drawings.h"
#include "knotreel/base/error.h"
#include "knotreel/features/detect.h"
#include "knotreel/features/fair.h"
#include "knotreel/features/image_mesh.h"
#include "support/pictures.h"

namespace knotreel::features {
namespace {

using Pixel = std::pair<int, int>;

/// Paper Eq. 6 on sets of pixels.
class SlowCorrection {
 public:
  SlowCorrection(const image::Image& image, const FeatureChains& chains)
      : image_(image), mesh_(make_image_mesh(chains)), feature_(testing::pixels_of(chains)) {}

  image::Image run() const {
    image::Image result = image_;
    for (int y = 0; y < image_.height; ++y) {
      for (int x = 0; x < image_.width; ++x) {
        const std::set<Pixel> one = clean_part({x, y});
        if (feature_.count({x, y}) || one.size() == neighbours({x, y}).size()) continue;
        std::set<Pixel> two;
        for (const Pixel& p : one) {
          for (const Pixel& q : clean_part(p)) {
            if (q != Pixel{x, y} && !one.count(q)) two.insert(q);
          }
        }
        bool away = false;
        for (const Pixel& p : two) away = away || clean_part(p).size() == neighbours(p).size();
        if (!away) continue;
        for (int c = 0; c < image_.channels; ++c) {
          result.at(x, y, c) = float(0.4 * mean(one, c) + 0.6 * mean(two, c));
        }
      }
    }
    return result;
  }

 private:
  std::set<Pixel> neighbours(Pixel p) const {
    std::set<Pixel> result;
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const int x = p.first + dx;
        const int y = p.second + dy;
        if ((dx == 0 && dy == 0) || x < 0 || y < 0 || x >= image_.width || y >= image_.height) continue;
        if (dx == 0 || dy == 0) {
          result.insert({x, y});
        } else {
          const int square = std::min(p.second, y) * (image_.width - 1) + std::min(p.first, x);
          if (mesh_.diagonals[std::size_t(square)] == (dx * dy > 0 ? 0 : 1)) result.insert({x, y});
        }
      }
    }
    return result;
  }

  std::set<Pixel> clean_part(Pixel p) const {
    std::set<Pixel> result;
    for (const Pixel& q : neighbours(p)) {
      if (!feature_.count(q)) result.insert(q);
    }
    return result;
  }

  double mean(const std::set<Pixel>& pixels, int c) const {
    double sum = 0;
    for (const auto& [x, y] : pixels) sum += double{image_.at(x, y, c)};
    return sum / double(pixels.size());
  }

  const image::Image& image_;
  ImageMesh mesh_;
  std::set<Pixel> feature_;
};

TEST(ColourCorrection, AgreesWithTheSlowReference) {
  for (unsigned seed = 0; seed < 6; ++seed) {
    const image::Image image = test::random_picture(60, 50, 1 + int(seed % 4), seed);
    DetectOptions options;
    options.min_weight = seed % 2 == 0 ? 0 : 600;
    const FeatureChains chains = detect_features(image, options);
    ASSERT_FALSE(chains.chains.empty());
    const image::Image corrected = correct_colours(image, chains);
    EXPECT_GT(test::largest_difference(corrected, image), 1);
    EXPECT_LT(test::largest_difference(corrected, SlowCorrection(image, chains).run()), 1e-4);
  }
}

TEST(ColourCorrection, BothSidesOfABlurredEdgeComeNearerToTheirColours) {
  // Mixed by the camera over about two pixels.
  const image::Image image = testing::draw(
      40, 40, [](double x, double y) { return 125 + 75 * std::tanh((x + 0.3 * y - 26) / 0.8); });
  FeatureChains chains = detect_features(image);
  ASSERT_EQ(chains.chains.size(), 1U);
  const auto error = [&](const image::Image& candidate) {
    const image::Image corrected = correct_colours(image, chains);
    double sum = 0;
    for (int y = 0; y < 40; ++y) {
      for (int x = 0; x < 40; ++x) {
        if (image.at(x, y, 0) == corrected.at(x, y, 0)) continue;
        const double own = x + 0.5 + 0.3 * (y + 0.5) < 26 ? 50 : 200;
        sum += std::abs(double{candidate.at(x, y, 0)} - own);
      }
    }
    return sum;
  };
  EXPECT_GT(error(image), 500);
  EXPECT_LT(error(correct_colours(image, chains)), 0.5 * error(image));
  EXPECT_LT(error(correct_colours(image, chains, {.clean_only = true})), 0.1 * error(image));
}

TEST(ColourCorrection, OnlyTheOneRingChanges) {
  const image::Image image = testing::disc(40, 20, 20, 9);
  const FeatureChains chains = detect_features(image);
  ASSERT_FALSE(chains.chains.empty());
  const auto feature = testing::pixels_of(chains);
  const image::Image corrected = correct_colours(image, chains);
  EXPECT_GT(test::largest_difference(corrected, image), 1);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      bool beside = false;
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) beside = beside || feature.count({x + dx, y + dy});
      }
      if (!beside || feature.count({x, y})) {
        EXPECT_EQ(corrected.at(x, y, 0), image.at(x, y, 0));
      }
    }
  }
}

TEST(ColourCorrection, ThinStripsKeepTheirColours) {
  for (const int width : {1, 2}) {
    image::Image image = test::random_picture(20, 30, 3, 1);
    FeatureChains chains{20, 30, {}, 4};
    for (const int column : {8, 9 + width}) {
      Chain chain;
      for (int y = 0; y < 30; ++y) chain.points.push_back({column, y, {column + 0.5, y + 0.5}});
      chain.first_node = NodeIndex(2 * chains.chains.size());
      chain.last_node = chain.first_node + 1;
      chains.chains.push_back(chain);
    }
    const image::Image corrected = correct_colours(image, chains);
    for (int y = 0; y < 30; ++y) {
      for (int x = 8; x <= 9 + width; ++x) EXPECT_EQ(corrected.at(x, y, 0), image.at(x, y, 0));
      EXPECT_NE(corrected.at(7, y, 0), image.at(7, y, 0)) << "outside there is enough";
    }
  }
}

TEST(ColourCorrection, NoColourCrossesAFeature) {
  image::Image image = image::make_image(40, 40, 1);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) image.at(x, y, 0) = x + y < 50 ? 10 : 240;
  }
  const FeatureChains chains = detect_features(image);
  ASSERT_EQ(chains.chains.size(), 1U);
  const auto feature = testing::pixels_of(chains);
  const image::Image corrected = correct_colours(image, chains);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      if (!feature.count({x, y}) && std::abs(x + y - 49.5) > 1) {
        EXPECT_FLOAT_EQ(corrected.at(x, y, 0), image.at(x, y, 0)) << x << " " << y;
      }
    }
  }
}

TEST(ColourCorrection, StrengthIsTheShareOfTheWay) {
  image::Image image = image::make_image(40, 40, 1);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) image.at(x, y, 0) = float(std::clamp(80 * (x + y) - 3900, 10, 240));
  }
  const FeatureChains chains = detect_features(image);
  ASSERT_FALSE(chains.chains.empty());
  const image::Image all = correct_colours(image, chains);
  EXPECT_NE(all.samples, image.samples);
  EXPECT_EQ(correct_colours(image, chains, {.strength = 0}).samples, image.samples);
  const image::Image part = correct_colours(image, chains, {.strength = 0.25});
  for (std::size_t i = 0; i < all.samples.size(); ++i) {
    EXPECT_NEAR(part.samples[i], image.samples[i] + 0.25F * (all.samples[i] - image.samples[i]), 1e-4);
  }
}

TEST(ColourCorrection, WrongArgumentsAreRefused) {
  const image::Image image = image::make_image(4, 4, 1);
  const FeatureChains chains{4, 4, {}, 0};
  EXPECT_THROW(correct_colours(image, FeatureChains{4, 5, {}, 0}), Error);
  EXPECT_THROW(correct_colours(image, chains, {.strength = 1.5}), Error);
  EXPECT_THROW(correct_colours(image, chains, {.one_ring = 0.5}), Error);
  EXPECT_THROW(correct_colours(image, chains, {.one_ring = -0.5, .two_ring = 1.5}), Error);
  EXPECT_EQ(correct_colours(image, chains).samples, image.samples);
}

}  // namespace
}  // namespace knotreel::features
