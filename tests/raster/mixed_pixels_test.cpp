// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/raster/mixed_pixels.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "knotreel/base/parallel.h"
#include "knotreel/raster/render.h"
#include "knotreel/spline/pixel_tiles.h"
#include "raster/feature_trace.h"
#include "raster/surface.h"
#include "support/models.h"

namespace knotreel::raster {
namespace {

constexpr std::uint64_t kMixedSeed = 20261128;

/// The mean of the colours at the places of a mixed pixel.
double mean_colour(const fit::MixedPixels& mixed, std::size_t i, const Surface& surface,
                   std::size_t channel) {
  double sum = 0;
  for (std::size_t k = mixed.begin[i]; k < mixed.begin[i + 1]; ++k)
    sum += mixed.shares[k] * surface.evaluate(mixed.places[k]).colour[channel];
  return sum;
}

TEST(MixedPixels, HaveTheColoursThatAreDrawn) {
  std::size_t split = 0;
  for (const auto& c : knotreel::testing::corpus_cases()) {
    if (c.mesh.segments.empty() || c.name == "knots-squeezed-on-feature") continue;
    SCOPED_TRACE(c.name);
    document::FrameModel model = knotreel::testing::blank_model(c.mesh, 2, 3);
    knotreel::testing::displace_randomly(model, 1, kMixedSeed);
    knotreel::testing::colour_randomly(model, kMixedSeed);
    const auto basis = std::make_shared<const spline::Basis>(model.space);
    const Surface surface(model, basis);
    const Renderer renderer(model, {}, basis);
    const image::Image drawn = renderer.whole();
    const fit::MixedPixels mixed = mixed_pixels(model, basis);
    const std::vector<CrossedPixel> crossed =
        FeatureTrace(surface, c.mesh).crossed_pixels(1, 1, 0, drawn.height, 0, drawn.width);
    ASSERT_EQ(mixed.pixels.size(), crossed.size());
    ASSERT_EQ(mixed.begin.size(), crossed.size() + 1);
    for (std::size_t i = 0; i < crossed.size(); ++i) {
      const CrossedPixel& p = crossed[i];
      EXPECT_EQ(mixed.pixels[i], static_cast<std::uint32_t>(p.y * drawn.width + p.x));
      // What is split is looked at in the same places, else in fewer.
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(mean_colour(mixed, i, surface, k), drawn.at(p.x, p.y, static_cast<int>(k)),
                    p.parts ? 1 : 255.0 / 8)
            << p.x << ' ' << p.y;
      split += p.parts ? 1 : 0;
    }
  }
  EXPECT_GT(split, 100U);
}

TEST(MixedPixels, OfSomeTilesAreThoseThatAreInThem) {
  const auto cases = knotreel::testing::corpus_cases();
  const auto c = std::find_if(cases.begin(), cases.end(), [](const auto& m) {
    return !m.mesh.segments.empty() && m.mesh.width > spline::PixelTiles::kSide;
  });
  ASSERT_NE(c, cases.end());
  document::FrameModel model = knotreel::testing::blank_model(c->mesh, 2, 1);
  knotreel::testing::displace_randomly(model, 1, kMixedSeed);
  const auto basis = std::make_shared<const spline::Basis>(model.space);
  const fit::MixedPixels all = mixed_pixels(model, basis);
  const auto width = static_cast<std::size_t>(c->mesh.width);
  constexpr std::size_t kSide = spline::PixelTiles::kSide;
  const std::size_t columns = (width + kSide - 1) / kSide;
  std::vector<std::uint8_t> tiles(columns * ((static_cast<std::size_t>(c->mesh.height) + kSide - 1) / kSide));
  for (std::size_t t = 0; t < tiles.size(); t += 2) tiles[t] = 1;
  const fit::MixedPixels some = mixed_pixels(model, basis, tiles);
  EXPECT_GT(some.pixels.size(), 0U);
  EXPECT_LT(some.pixels.size(), all.pixels.size());
  std::size_t k = 0;
  for (std::size_t i = 0; i < all.pixels.size(); ++i) {
    if (!tiles[all.pixels[i] / width / kSide * columns + all.pixels[i] % width / kSide]) continue;
    ASSERT_LT(k, some.pixels.size());
    EXPECT_EQ(some.pixels[k], all.pixels[i]);
    ASSERT_EQ(some.begin[k + 1] - some.begin[k], all.begin[i + 1] - all.begin[i]);
    EXPECT_TRUE(
        std::equal(&some.places[some.begin[k]], &some.places[some.begin[k + 1]], &all.places[all.begin[i]]));
    ++k;
  }
  EXPECT_EQ(k, some.pixels.size());
}

TEST(MixedPixels, AreTheSameForAnyNumberOfThreads) {
  const auto cases = knotreel::testing::corpus_cases();
  const auto c =
      std::find_if(cases.begin(), cases.end(), [](const auto& m) { return !m.mesh.segments.empty(); });
  ASSERT_NE(c, cases.end());
  document::FrameModel model = knotreel::testing::blank_model(c->mesh, 2, 1);
  knotreel::testing::displace_randomly(model, 1, kMixedSeed);
  const auto basis = std::make_shared<const spline::Basis>(model.space);
  const auto with_threads = [&](int threads) {
    const ThreadCap cap(threads);
    return mixed_pixels(model, basis);
  };
  const fit::MixedPixels one = with_threads(1);
  const fit::MixedPixels four = with_threads(4);
  EXPECT_EQ(one.pixels, four.pixels);
  EXPECT_EQ(one.places, four.places);
  EXPECT_EQ(one.shares, four.shares);
}

}  // namespace
}  // namespace knotreel::raster
