// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/edge_colours.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "fit/fit_cases.h"

namespace knotreel::fit {
namespace {

TEST(EdgeColours, ArePixelsOfTheSideOnWhichTheCentreLies) {
  testing::MeshBuilder b(32, 24);
  b.segment(b.vertex(15.8, 4), b.vertex(16.2, 20), 1);
  b.free(7, 12);
  b.free(25, 11);
  const mesh::KnotMesh mesh = b.triangulated();
  // Left of the feature another colour than on the right, and mixtures where it passes.
  const auto is_right = [](Vec2 p) { return p.x > 15.8 + 0.4 * (p.y - 4) / 16; };
  image::Image picture = image::make_image(32, 24, 3);
  std::vector<Vec2> places;
  std::vector<std::uint8_t> crossed(32 * 24, 0);
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    places.push_back(testing::pixel_centre(i, 32));
    crossed[i] = std::abs(places[i].x - 16) < 1 && places[i].y > 5 && places[i].y < 19 ? 1 : 0;
    for (std::size_t c = 0; c < 3; ++c)
      picture.samples[3 * i + c] = crossed[i] ? 99 : (is_right(places[i]) ? 200.0F : 10.0F) + float(c);
  }
  const std::vector<std::uint8_t> given = clear_edge_colours(picture, places, crossed, mesh);
  EXPECT_EQ(given, crossed) << "all have neighbours on their side";
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c)
      ASSERT_EQ(picture.samples[3 * i + c], (is_right(places[i]) ? 200.0F : 10.0F) + float(c)) << i;
  }
}

TEST(EdgeColours, PixelsWithoutANeighbourOnTheirSideKeepTheirs) {
  testing::MeshBuilder b(16, 16);
  b.segment(b.vertex(8.2, 4), b.vertex(8.2, 12), 1);
  const mesh::KnotMesh mesh = b.triangulated();
  image::Image picture = image::make_image(16, 16, 1);
  std::vector<Vec2> places;
  for (std::size_t i = 0; i < 256; ++i) places.push_back(testing::pixel_centre(i, 16));
  std::fill(picture.samples.begin(), picture.samples.end(), 50.0F);
  picture.at(8, 8, 0) = 99;
  const std::vector<std::uint8_t> all(256, 1);
  const std::vector<std::uint8_t> given = clear_edge_colours(picture, places, all, mesh);
  EXPECT_EQ(given, std::vector<std::uint8_t>(256, 0));
  EXPECT_EQ(picture.at(8, 8, 0), 99);
  const std::vector<float> weights = edge_weights(all, given);
  EXPECT_EQ(weights, std::vector<float>(256, 0.0F));
  EXPECT_EQ(edge_weights(all, all), std::vector<float>(256, kEdgeWeight));
  EXPECT_EQ(edge_weights(given, given), std::vector<float>(256, 1.0F));
}

}  // namespace
}  // namespace knotreel::fit
