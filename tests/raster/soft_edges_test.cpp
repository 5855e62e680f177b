// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "knotreel/base/error.h"
#include "knotreel/raster/edge_softness.h"
#include "knotreel/raster/render.h"
#include "raster/feature_trace.h"
#include "raster/soften.h"
#include "raster/surface.h"
#include "support/models.h"
#include "support/pictures.h"

namespace knotreel::raster {
namespace {

using document::FrameModel;
using knotreel::testing::MeshBuilder;

constexpr std::uint64_t kSoftEdgesSeed = 20261125;

/// A loop and an open line, which ends inside, in random colours.
FrameModel featured_model(int channels) {
  MeshBuilder b(48, 40);
  b.free(8, 9);
  b.free(40, 20);
  b.free(22, 17);
  const auto v0 = b.vertex(14, 10);
  const auto v1 = b.vertex(31, 12);
  const auto v2 = b.vertex(24, 26);
  b.segment(v0, v1, 1);
  b.segment(v1, v2, 2);
  b.segment(v2, v0, 1);
  b.segment(b.vertex(0, 33), b.vertex(36, 34), 1);
  FrameModel model = knotreel::testing::blank_model(b.triangulated(), 2, channels);
  knotreel::testing::displace_randomly(model, 1.5, kSoftEdgesSeed);
  knotreel::testing::colour_randomly(model, kSoftEdgesSeed);
  return model;
}

image::Image drawn(const FrameModel& model, int width = 0, int height = 0) {
  RenderOptions options;
  options.width = width;
  options.height = height;
  image::Image picture{width ? width : 48, height ? height : 40, model.channels, {}};
  picture.samples = render(model, options);
  return picture;
}

TEST(SoftEdges, AreThePictureWithHardOnesThroughTheFilterNextToFeaturesAndNowhereElse) {
  FrameModel model = featured_model(3);
  const FeatureTrace trace(Surface(model), model.space->mesh());
  for (const int scale : {1, 3}) {
    const int width = 48 * scale;
    const int height = 40 * scale;
    model.edge_softness = 0;
    const image::Image hard = drawn(model, width, height);
    model.edge_softness = 0.15;
    const image::Image soft = drawn(model, width, height);
    const auto crossed = trace.crossed_pixels(1.0 / scale, 1.0 / scale, 0, height, 0, width);
    int near = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const bool is_near = std::any_of(crossed.begin(), crossed.end(), [&](const CrossedPixel& p) {
          return std::abs(p.x - x) <= 1 && std::abs(p.y - y) <= 1;
        });
        near += is_near;
        for (int c = 0; c < 3; ++c) {
          const auto expected = is_near ? test::softened(hard, x, y, c, 0.15) : hard.at(x, y, c);
          ASSERT_NEAR(soft.at(x, y, c), expected, is_near ? 1e-3 : 0) << x << ' ' << y;
        }
      }
    }
    EXPECT_GT(near, 200 * scale);
    EXPECT_LT(near, width * height / 2);
  }
}

TEST(SoftEdges, EqualTheReference) {
  FrameModel model = featured_model(1);
  model.edge_softness = 0.2;
  RenderOptions window;
  window.width = 48;
  window.height = 40;
  window.crop_width = 4;
  window.crop_height = 3;
  for (const auto& [x, y] : std::vector<std::array<int, 2>>{{14, 9}, {34, 31}, {0, 30}}) {
    window.crop_x = x;
    window.crop_y = y;
    const std::vector<float> fast = render(model, window);
    const std::vector<float> slow = render_reference(model, window);
    // Coverage is right to a sixteenth, and the filter takes a mean of that.
    for (std::size_t i = 0; i < fast.size(); ++i) EXPECT_NEAR(fast[i], slow[i], 255.0 / 16) << i;
  }
}

TEST(SoftEdges, AreNotDrawnWithoutAntialiasing) {
  FrameModel model = featured_model(3);
  const std::vector<float> hard = render(model, {.antialias = false});
  model.edge_softness = 0.25;
  EXPECT_EQ(render(model, {.antialias = false}), hard);
}

TEST(SoftEdges, InvisibleColoursDoNotBleed) {
  // Grey and alpha: opaque at the left, transparent with a colour of no meaning at the right.
  std::vector<float> samples;
  for (int i = 0; i < 9; ++i)
    samples.insert(samples.end(), {i % 3 < 2 ? 40.0F : 1000.0F, i % 3 < 2 ? 255.0F : 0.0F});
  const Part part{{0, 3, 0, 3}, 2, samples.data()};
  const std::vector<CrossedPixel> crossed{{1, 1, std::nullopt}};
  soften_edges(crossed, 0.25, {{1, 2, 1, 2}, 2, samples.data()}, part);
  EXPECT_FLOAT_EQ(part.at(1, 1)[0], 40);
  EXPECT_FLOAT_EQ(part.at(1, 1)[1], 0.75F * 255);
  EXPECT_FLOAT_EQ(part.at(2, 1)[0], 1000) << "only the inner part changes";
}

TEST(FittingEdgeSoftness, IsThatOfThePicture) {
  for (const int channels : {1, 3, 4}) {
    FrameModel model = featured_model(channels);
    for (const double softness : {0.0, 1.0 / 256, 0.0625, 0.125, 0.25}) {
      model.edge_softness = softness;
      const image::Image picture = drawn(model);
      if (channels == 4 && softness > 0) continue;  // colours are mixed by opacity, which is not linear
      model.edge_softness = 0.1;
      EXPECT_EQ(fitting_edge_softness(model, picture, nullptr, nullptr), softness) << channels;
      const auto basis = std::make_shared<const spline::Basis>(model.space);
      EXPECT_EQ(fitting_edge_softness(model, picture, basis, nullptr), softness) << channels;
    }
  }
}

TEST(FittingEdgeSoftness, IsWithinBoundsWhateverThePicture) {
  FrameModel model = featured_model(1);
  model.edge_softness = 0.25;
  image::Image picture = drawn(model);
  // Softer than any edge that is drawn.
  for (int round = 0; round < 3; ++round) picture = test::softened(picture, 0.25);
  EXPECT_EQ(fitting_edge_softness(model, picture, nullptr, nullptr), document::kMostEdgeSoftness);
}

TEST(FittingEdgeSoftness, IsNoneWithoutFeatures) {
  MeshBuilder b(48, 40);
  b.free(20, 20);
  FrameModel model = knotreel::testing::blank_model(b.triangulated(), 2, 1);
  knotreel::testing::colour_randomly(model, kSoftEdgesSeed);
  EXPECT_EQ(fitting_edge_softness(model, drawn(model), nullptr, nullptr), 0);
}

TEST(FittingEdgeSoftness, RefusesPicturesOfAnotherSize) {
  const FrameModel model = featured_model(1);
  EXPECT_THROW(fitting_edge_softness(model, image::make_image(48, 41, 1), nullptr, nullptr), Error);
  EXPECT_THROW(fitting_edge_softness(model, image::make_image(48, 40, 3), nullptr, nullptr), Error);
}

}  // namespace
}  // namespace knotreel::raster
