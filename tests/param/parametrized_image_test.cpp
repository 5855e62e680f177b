// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/param/parametrized_image.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "support/chains.h"

namespace knotreel::param {
namespace {

using features::FeatureChains;
using image::Image;
using image::make_image;
using knotreel::testing::arc;
using knotreel::testing::ChainBuilder;
using knotreel::testing::random_chains;

template <typename Colour>
Image picture(const FeatureChains& chains, int channels, const Colour& colour) {
  Image image = make_image(chains.width, chains.height, channels);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < channels; ++c) image.at(x, y, c) = colour(x, y, c);
    }
  }
  return image;
}

ParametrizedImage resampled(const Image& image, const FeatureChains& chains,
                            Parametrization* result = nullptr) {
  const auto mesh = features::make_image_mesh(chains);
  const Parametrization p = parametrize(chains, mesh);
  if (result != nullptr) *result = p;
  return parametrized_image(image, chains, mesh, p);
}

float noise(int x, int y, int c) {
  return static_cast<float>((x * 7919 + y * 104729 + c * 1299709) % 256);
}

/// Distance of a point to the nearest feature polyline.
double distance_to_polylines(const Parametrization& p, Vec2 q) {
  double least = 1e9;
  for (const Polyline& line : p.polylines) {
    const std::size_t n = line.vertices.size();
    for (std::size_t i = 0; i + (line.closed ? 0 : 1) < n; ++i) {
      const Vec2 a = p.vertices[line.vertices[i]].position;
      const Vec2 d = p.vertices[line.vertices[(i + 1) % n]].position - a;
      const double t = std::clamp(dot(q - a, d) / dot(d, d), 0.0, 1.0);
      least = std::min(least, norm(q - a - t * d));
    }
  }
  return least;
}

/// Even-odd rule.
bool inside_polygon(const Parametrization& p, const Polyline& line, Vec2 q) {
  bool inside = false;
  const std::size_t n = line.vertices.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Vec2 a = p.vertices[line.vertices[i]].position;
    const Vec2 b = p.vertices[line.vertices[(i + 1) % n]].position;
    if ((a.y > q.y) == (b.y > q.y)) continue;
    if (q.x < a.x + (q.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

TEST(ParametrizedImage, WithoutFeaturesIsThePicture) {
  for (const auto& [w, h] : {std::pair{1, 1}, {1, 5}, {2, 2}, {3, 3}, {31, 20}}) {
    FeatureChains none;
    none.width = w;
    none.height = h;
    const Image image = picture(none, 3, noise);
    const ParametrizedImage result = resampled(image, none);
    EXPECT_EQ(result.colours.samples, image.samples);
    EXPECT_EQ(result.weights, std::vector<float>(image.pixel_count(), 1.0F));
  }
}

TEST(ParametrizedImage, FarFromFeaturesSamplesAreCopied) {
  ChainBuilder b(320, 100);
  ASSERT_TRUE(b.add(arc({40, 50}, 20), true));
  const Image image = picture(b.chains, 3, noise);
  Parametrization p;
  const ParametrizedImage result = resampled(image, b.chains, &p);
  int changed_far = 0;
  int changed_near = 0;
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 320; ++x) {
      const bool same = result.colours.at(x, y, 1) == image.at(x, y, 1);
      (x > 180 ? changed_far : changed_near) += same ? 0 : 1;
    }
  }
  EXPECT_EQ(changed_far, 0);
  EXPECT_GT(changed_near, 1000);
}

TEST(ParametrizedImage, AConstantPictureStaysConstant) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const FeatureChains chains = random_chains(110, 90, 10, seed);
    const Image image =
        picture(chains, 4, [](int, int, int c) { return 17.3F + 50 * static_cast<float>(c); });
    EXPECT_EQ(resampled(image, chains).colours.samples, image.samples);
  }
}

/// White inside of a circle and black outside; feature pixels have a colour of neither.
TEST(ParametrizedImage, SidesOfACurveDoNotMix) {
  for (const double radius : {4.0, 9.0, 17.0, 33.0}) {
    ChainBuilder b(120, 110);
    ASSERT_TRUE(b.add(arc({60.3, 54.2}, radius), true));
    Image image = picture(b.chains, 3, [&](int x, int y, int) {
      return norm(Vec2{x + 0.5, y + 0.5} - Vec2{60.3, 54.2}) < radius ? 255.0F : 0.0F;
    });
    for (const auto& point : b.chains.chains[0].points) image.at(point.x, point.y, 0) = 99;
    Parametrization p;
    const ParametrizedImage result = resampled(image, b.chains, &p);
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        const auto i = static_cast<std::size_t>(y * image.width + x);
        const float v = result.colours.samples[3 * i];
        ASSERT_TRUE(v == 0 || v == 255) << v << " at " << x << "," << y;
        if (result.weights[i] == 0) continue;
        const bool inside = inside_polygon(p, p.polylines[0], {x + 0.5, y + 0.5});
        ASSERT_EQ(v, inside ? 255 : 0) << "at " << x << "," << y;
      }
    }
  }
}

/// A curve from side to side, black above and white below.
TEST(ParametrizedImage, SidesDoNotMixAtTheBorder) {
  for (const double end : {12.5, 20.5, 30.5, 45.5}) {
    ChainBuilder b(70, 60);
    ASSERT_TRUE(b.add({{0.5, 25.5}, {20.5, 31.5}, {40.5, 22.5}, {69.5, end}}));
    std::vector<int> row(70, -1);
    for (const auto& point : b.chains.chains[0].points) {
      row[static_cast<std::size_t>(point.x)] = std::max(row[static_cast<std::size_t>(point.x)], point.y);
    }
    const Image image = picture(
        b.chains, 1, [&](int x, int y, int) { return y > row[static_cast<std::size_t>(x)] ? 255.0F : 0.0F; });
    Parametrization p;
    const ParametrizedImage result = resampled(image, b.chains, &p);
    ASSERT_NE(p.vertices.front().place, VertexPlace::kInside);
    ASSERT_NE(p.vertices.back().place, VertexPlace::kInside);
    for (int x = 0; x < 70; ++x) {
      bool below = false;
      for (int y = 0; y < 60; ++y) {
        const auto i = static_cast<std::size_t>(y * 70 + x);
        below = below || result.weights[i] == 0;
        ASSERT_TRUE(result.colours.samples[i] == 0 || result.colours.samples[i] == 255);
        if (result.weights[i] == 0) continue;
        ASSERT_EQ(result.colours.samples[i], below ? 255 : 0) << x << "," << y;
      }
    }
  }
}

TEST(ParametrizedImage, CrossedPixelsHaveNoWeightAndAllOthersDo) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const FeatureChains chains = random_chains(120, 80, 8, seed);
    Parametrization p;
    const ParametrizedImage result = resampled(picture(chains, 1, noise), chains, &p);
    for (int y = 0; y < 80; ++y) {
      for (int x = 0; x < 120; ++x) {
        const double distance = distance_to_polylines(p, {x + 0.5, y + 0.5});
        const float weight = result.weights[static_cast<std::size_t>(y * 120 + x)];
        const auto message = ::testing::Message() << x << "," << y;
        if (distance < 0.499) {
          EXPECT_EQ(weight, 0) << message;
        }
        // Farther than half a diagonal only triangles of three feature pixels, at nodes, have none.
        if (distance > 1.5) {
          EXPECT_EQ(weight, 1) << message;
        }
      }
    }
  }
}

TEST(ParametrizedImage, ALinearPictureBecomesTheInverseMap) {
  // Where no feature pixel is near, the colour x of the picture is the x of the image mesh's inverse.
  ChainBuilder b(140, 120);
  ASSERT_TRUE(b.add(arc({70, 60}, 30), true));
  const Image image = picture(b.chains, 1, [](int x, int, int) { return static_cast<float>(x) + 0.5F; });
  Parametrization p;
  const ParametrizedImage result = resampled(image, b.chains, &p);
  // Forward: interpolating the resampled picture at a pixel's parameter gives the colour of that pixel.
  for (int y = 45; y < 75; ++y) {
    for (int x = 55; x < 85; ++x) {
      const Vec2 u = p.parameter[static_cast<std::size_t>(y * 140 + x)];
      const int i = static_cast<int>(std::floor(u.x - 0.5));
      const int k = static_cast<int>(std::floor(u.y - 0.5));
      const double s = u.x - 0.5 - i;
      const double t = u.y - 0.5 - k;
      const auto at = [&](int dx, int dy) {
        return static_cast<double>(result.colours.at(i + dx, k + dy, 0));
      };
      const double v =
          (1 - t) * ((1 - s) * at(0, 0) + s * at(1, 0)) + t * ((1 - s) * at(0, 1) + s * at(1, 1));
      EXPECT_NEAR(v, x + 0.5, 0.05);
    }
  }
}

TEST(ParametrizedImage, SameBitsForAnyNumberOfThreads) {
  const FeatureChains chains = random_chains(200, 150, 25, 3);
  const Image image = picture(chains, 3, noise);
  const auto with = [&](int threads) {
    const ThreadCap cap(threads);
    return resampled(image, chains);
  };
  const ParametrizedImage one = with(1);
  const ParametrizedImage two = with(2);
  EXPECT_EQ(one.colours.samples, two.colours.samples);
  EXPECT_EQ(one.weights, two.weights);
}

TEST(ParametrizedImage, FeaturesEverywhereAreSurvived) {
  ChainBuilder b(5, 1);
  ASSERT_TRUE(b.add({{0.5, 0.5}, {4.5, 0.5}}));
  const ParametrizedImage result = resampled(picture(b.chains, 1, noise), b.chains);
  EXPECT_EQ(result.weights, std::vector<float>(5, 0.0F));
}

TEST(ParametrizedImage, OtherSizesAreRefused) {
  const FeatureChains chains = random_chains(60, 50, 3, 1);
  const auto mesh = features::make_image_mesh(chains);
  EXPECT_THROW(parametrized_image(make_image(61, 50, 3), chains, mesh, parametrize(chains, mesh)), Error);
}

}  // namespace
}  // namespace knotreel::param
