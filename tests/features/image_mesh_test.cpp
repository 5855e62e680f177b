// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/features/image_mesh.h"

#include <gtest/gtest.h>

#include <set>

#include "features/drawings.h"
#include "knotreel/features/detect.h"
#include "support/pictures.h"

namespace knotreel::features {
namespace {

TEST(ImageMesh, EachStepOfAChainIsAnEdge) {
  const FeatureChains chains = detect_features(test::random_picture(70, 60, 1, 2));
  const ImageMesh mesh = make_image_mesh(chains);
  ASSERT_EQ(mesh.diagonals.size(), 69U * 59U);
  std::set<std::size_t> flipped;
  for (const Chain& chain : chains.chains) {
    for (std::size_t i = chain.closed ? 0 : 1; i < chain.points.size(); ++i) {
      const ChainPoint& p = chain.points[i];
      const ChainPoint& q = chain.points[i == 0 ? chain.points.size() - 1 : i - 1];
      if (p.x == q.x || p.y == q.y) continue;
      const auto square = std::size_t(std::min(p.y, q.y)) * 69 + std::size_t(std::min(p.x, q.x));
      const int expected = (p.x - q.x) * (p.y - q.y) > 0 ? 0 : 1;
      EXPECT_EQ(mesh.diagonals[square], expected);
      if (expected == 1) flipped.insert(square);
    }
  }
  std::size_t ones = 0;
  for (const auto diagonal : mesh.diagonals) ones += diagonal;
  EXPECT_EQ(ones, flipped.size()) << "no square is flipped without need";
  EXPECT_GT(ones, 10U);
}

TEST(ImageMesh, PicturesOfOnePixelHaveNoSquares) {
  EXPECT_TRUE(make_image_mesh(FeatureChains{1, 1, {}, 0}).diagonals.empty());
  EXPECT_TRUE(make_image_mesh(FeatureChains{7, 1, {}, 0}).diagonals.empty());
}

}  // namespace
}  // namespace knotreel::features
