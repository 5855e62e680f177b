// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/drawn_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <span>
#include <string>

#include "knotreel/base/parallel.h"
#include "knotreel/fit/geometry_fit.h"
#include "knotreel/spline/space.h"
#include "support/drawn_scene.h"
#include "support/pictures.h"

namespace knotreel::track {
namespace {

using test::drawing;

constexpr FeatureLimits kAll{.share = 0.6};

vectorize::Options options() {
  return vectorize::drawn_video_options({});
}

DrawnFeatures features_of(const image::Image& picture, std::size_t most_functions,
                          std::span<const Vec2> vertices, const FeatureLimits& before,
                          Drawing how = Drawing::kPlain) {
  return {picture, options(), *find_drawn_curves(picture, options(), how), most_functions, vertices, before};
}

std::vector<Vec2> vertices_of(const mesh::KnotMesh& mesh) {
  std::vector<Vec2> result;
  for (const mesh::Knot& k : mesh.knots)
    if (k.kind == mesh::KnotKind::kVertex) result.push_back(k.position);
  return result;
}

class DrawnFeaturesOn : public ::testing::TestWithParam<Drawing> {};

INSTANTIATE_TEST_SUITE_P(Grids, DrawnFeaturesOn, ::testing::Values(Drawing::kPlain, Drawing::kFineGrid));

TEST_P(DrawnFeaturesOn, CurvesComeToLieOnTheEdges) {
  const image::Image picture = drawing(40, 40);
  const DrawnFeatures features = features_of(picture, 1000, {}, kAll, GetParam());
  EXPECT_EQ(features.knots().width, 120);
  EXPECT_EQ(features.knots().height, 90);
  EXPECT_EQ(features.limits().fine_grid, GetParam() == Drawing::kFineGrid);
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(features.knots(), 2));
  const std::vector<Vec2> displacement = features.displacement(basis, 0.95, 1.0 / 16);
  // Of the disk: all that is not of the box.
  std::vector<Vec2> points;
  for (const mesh::FeatureSegment& s : features.knots().segments) {
    const Vec2 a = features.knots().knots[s.knots.front()].position;
    const Vec2 b = features.knots().knots[s.knots.back()].position;
    for (int i = 1; i < 8; ++i) points.push_back(a + (i / 8.0) * (b - a));
  }
  const std::vector<Vec2> drawn = fit::image_points(basis, displacement, points);
  int of_disk = 0;
  double sum = 0;
  for (const Vec2 p : drawn) {
    const double off = std::abs(norm(p - Vec2{40, 40}) - 20);
    if (off > 1) continue;
    ++of_disk;
    sum += off;
  }
  EXPECT_GT(of_disk, 40);
  EXPECT_LT(sum / of_disk, 0.08);
}

TEST_P(DrawnFeaturesOn, VerticesStayWhereTheyMayAsWell) {
  const image::Image before = drawing(40, 40);
  const image::Image now = drawing(41.3, 40.4);
  const DrawnFeatures first = features_of(before, 1000, {}, kAll, GetParam());
  std::vector<Vec2> moved = vertices_of(first.knots());
  for (Vec2& v : moved) {
    if (std::abs(norm(v - Vec2{40, 40}) - 20) < 1.5) v = v + Vec2{1.3, 0.4};
  }
  const auto kept = [&](const DrawnFeatures& features) {
    const std::vector<Vec2> found = vertices_of(features.knots());
    return std::count_if(moved.begin(), moved.end(), [&](Vec2 v) {
      return std::any_of(found.begin(), found.end(), [&](Vec2 w) { return norm(v - w) < 1; });
    });
  };
  const DrawnFeatures led = features_of(now, 1000, moved, kAll, GetParam());
  const DrawnFeatures alone = features_of(now, 1000, {}, kAll, GetParam());
  EXPECT_GT(kept(led), kept(alone));
  EXPECT_GE(kept(led), std::ptrdiff_t(moved.size()) - 2);
  EXPECT_LE(vertices_of(led.knots()).size(), vertices_of(alone.knots()).size() + 4);
}

/// Strokes of a pixel, two pixels apart.
TEST(DrawnFeatures, ThinStrokesHaveBothSidesOnTheFineGrid) {
  constexpr int kStrokes = 5;
  image::Image picture = image::make_image(120, 90, 3);
  std::fill(picture.samples.begin(), picture.samples.end(), 240.0F);
  for (int y = 10; y < 80; ++y) {
    for (int k = 0; k < kStrokes; ++k) {
      for (int c = 0; c < 3; ++c) {
        picture.at(50 + 3 * k, y, c) = 40;
      }
    }
  }
  const auto length = [&](Drawing how) {
    double sum = 0;
    const mesh::KnotMesh knots = features_of(picture, 10000, {}, kAll, how).knots();
    for (const mesh::FeatureSegment& s : knots.segments)
      sum += std::abs(knots.knots[s.knots.front()].position.y - knots.knots[s.knots.back()].position.y);
    return sum / 70;
  };
  EXPECT_GT(length(Drawing::kFineGrid), 2 * kStrokes - 0.5);
  EXPECT_LT(length(Drawing::kPlain), 2 * kStrokes - 1.5);
}

/// Ten strokes with round ends anywhere in 160x120, three pixels wide, antialiased.
image::Image strokes(std::uint64_t seed, double ground, double ink) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> x(12, 148), y(12, 108);
  std::vector<std::pair<Vec2, Vec2>> lines(10);
  for (auto& [a, b] : lines) {
    a = {x(random), y(random)};
    b = {x(random), y(random)};
  }
  image::Image picture = image::make_image(160, 120, 3);
  for (int j = 0; j < picture.height; ++j) {
    for (int i = 0; i < picture.width; ++i) {
      double least = 1e9;
      for (const auto& [a, b] : lines) least = std::min(least, distance_to_segment({i + 0.5, j + 0.5}, a, b));
      const double cover = std::clamp(2 - least, 0.0, 1.0);
      for (int c = 0; c < 3; ++c)
        picture.at(i, j, c) = static_cast<float>((1 - cover) * ground + cover * (ink + 20 * c));
    }
  }
  return picture;
}

/// Else each of them would be a frame that is made from its picture alone.
TEST(DrawnFeatures, MakeSoundMeshesWhereDrawingsFadeIntoEachOther) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    const image::Image from = strokes(2 * seed, 245, 30);
    const image::Image to = strokes(2 * seed + 1, 60, 200);
    for (const double share : {0.25, 0.4, 0.5, 0.6, 0.75}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", share " + std::to_string(share));
      image::Image picture = from;
      for (std::size_t i = 0; i < picture.samples.size(); ++i) {
        const auto t = static_cast<float>(share);
        picture.samples[i] = std::round((1 - t) * from.samples[i] + t * to.samples[i]);
      }
      for (const Drawing how : {Drawing::kPlain, Drawing::kFineGrid})
        EXPECT_TRUE(features_of(picture, 10000, {}, kAll, how).is_sound());
    }
  }
}

/// A bound at which features just about have to go: what is there stays, and what is not stays away.
TEST(DrawnFeatures, LimitsGiveWayToWhatWasBefore) {
  const image::Image picture = drawing(40, 40);
  const DrawnFeatures all = features_of(picture, 10000, {}, kAll);
  ASSERT_FALSE(all.limits().strong_dropped);
  const std::size_t most = all.knots().knots.size();
  std::size_t stays = 0;
  std::size_t returns = 0;
  for (std::size_t bound = most; bound < 12 * most; bound += most / 8) {
    const DrawnFeatures had = features_of(picture, bound, {}, {.share = 0.6});
    const DrawnFeatures lacked =
        features_of(picture, bound, {}, {.share = 0.6, .weak_dropped = true, .strong_dropped = true});
    if (stays == 0 && !had.limits().strong_dropped) stays = bound;
    if (returns == 0 && !lacked.limits().strong_dropped) returns = bound;
  }
  ASSERT_GT(stays, most);
  ASSERT_GT(returns, 0U);
  EXPECT_GT(double(returns), 1.4 * double(stays));
}

TEST(DrawnFeatures, APictureWithoutFeaturesHasTheDomainAlone) {
  image::Image flat = image::make_image(40, 30, 3);
  const DrawnFeatures features = features_of(flat, 1000, std::vector<Vec2>{{3, 4}}, kAll);
  EXPECT_EQ(features.knots().knots.size(), 4U);
  EXPECT_TRUE(features.knots().segments.empty());
  const spline::Basis basis(std::make_shared<const spline::SplineSpace>(features.knots(), 2));
  for (const Vec2 d : features.displacement(basis, 0.95, 1.0 / 16)) EXPECT_EQ(d, Vec2{});
}

/// Whichever picture was done last, and whatever is done beside it.
TEST(DrawnCurves, OfSeveralFramesAtOnceAreThoseOfEachAlone) {
  const std::vector<image::Image> pictures = test::drawn_clip(8);
  const auto known = std::make_shared<KnownDrawings>();
  std::vector<std::shared_ptr<const DrawnCurves>> found(pictures.size());
  parallel_for(pictures.size(), [&](std::size_t i) {
    found[i] = find_drawn_curves(pictures[i], options(), Drawing::kFineGrid, known);
  });
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const auto alone = find_drawn_curves(pictures[i], options(), Drawing::kFineGrid);
    const std::vector<features::Chain>& chains = alone->found.faired.chains;
    ASSERT_EQ(found[i]->found.faired.chains.size(), chains.size()) << i;
    for (std::size_t c = 0; c < chains.size(); ++c) {
      EXPECT_TRUE(std::ranges::equal(found[i]->found.faired.chains[c].points, chains[c].points,
                                     [](const features::ChainPoint& a, const features::ChainPoint& b) {
                                       return a.position == b.position && a.beyond == b.beyond;
                                     }))
          << i << ' ' << c;
    }
  }
}

TEST(DrawnCurves, AreForgottenWhereTheClipIsNoDrawing) {
  const auto known = std::make_shared<KnownDrawings>();
  ASSERT_NE(find_drawn_curves(drawing(40, 40), options(), Drawing::kPlain, known), nullptr);
  EXPECT_NE(known->last(), nullptr);
  EXPECT_EQ(find_drawn_curves(test::random_picture(64, 48, 3, 1), options(), Drawing::kPlain, known),
            nullptr);
  EXPECT_EQ(known->last(), nullptr);
}

}  // namespace
}  // namespace knotreel::track
