// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/vectorize/vectorize.h"
#include "knotreel/document/stored_mesh.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <sstream>

#include "knotreel/base/error.h"
#include "knotreel/document/writer.h"
#include "knotreel/features/captions.h"
#include "knotreel/features/flat_share.h"
#include "support/pictures.h"
#include "vectorize/scenes.h"

namespace knotreel::vectorize {
namespace {

void expect_sound(const Vectorization& v, const image::Image& picture) {
  ASSERT_TRUE(v.model.space);
  EXPECT_FALSE(mesh::find_defect(v.model.space->mesh()));
  EXPECT_EQ(v.model.channels, picture.channels);
  EXPECT_EQ(v.model.displacement.size(), v.model.space->geometry_count());
  EXPECT_EQ(v.model.colour.size(),
            v.model.space->function_count() * static_cast<std::size_t>(picture.channels));
  for (const double c : v.model.colour) {
    ASSERT_TRUE(std::isfinite(c));
    ASSERT_LT(std::abs(c), 20000);  // noise of few pixels per function
  }
  EXPECT_FALSE(v.report.features_dropped);
  EXPECT_EQ(v.report.folds_left, 0);
}

TEST(Vectorize, ContoursStaySharpWhenEnlarged) {
  const image::Image picture = still_life(120, 90);
  const Vectorization v = vectorize_picture(picture);
  expect_sound(v, picture);
  EXPECT_GT(psnr(picture, v.model), 38);
  // Across the contour of the disc, at 8x: the colours of the two sides, and one or two pixels in between.
  const raster::RenderOptions options{.width = 960, .height = 720};
  const image::Image large = rendered(v.model, options);
  const int y = static_cast<int>(0.45 * 720);
  const int x = static_cast<int>(8 * (0.4 * 120 - 0.3 * 90));
  const float ground = large.at(x - 12, y, 0);
  const float disc = large.at(x + 12, y, 0);
  ASSERT_GT(disc - ground, 60);
  int between = 0;
  for (int i = x - 12; i <= x + 12; ++i) {
    const float share = (large.at(i, y, 0) - ground) / (disc - ground);
    if (share > 0.15F && share < 0.85F) ++between;
  }
  EXPECT_LE(between, 2);
}

TEST(Vectorize, ColoursThatAlphaHidesDoNotMatter) {
  // A bright disc on nothing, which files have as black.
  image::Image picture = image::make_image(80, 60, 4);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      const double in = 20 - std::hypot(x + 0.5 - 40, y + 0.5 - 30);
      const auto alpha = static_cast<float>(255 * std::clamp(in + 0.5, 0.0, 1.0));
      if (alpha < 1) continue;
      picture.at(x, y, 0) = 250;
      picture.at(x, y, 1) = 220;
      picture.at(x, y, 2) = 60;
      picture.at(x, y, 3) = alpha;
    }
  }
  image::Image other = picture;
  for (std::size_t i = 0; i < other.samples.size(); ++i) {
    if (other.samples[i - i % 4 + 3] == 0 && i % 4 != 3) other.samples[i] = static_cast<float>(i * 37 % 256);
  }
  const Vectorization v = vectorize_picture(picture);
  expect_sound(v, picture);
  EXPECT_TRUE(vectorize_picture(other).model.colour == v.model.colour);
  EXPECT_GT(psnr(picture, v.model), 40);
  // No fringe when enlarged: where anything is seen, it has the colour of the disc.
  const image::Image large = rendered(v.model, {.width = 640, .height = 480});
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      if (large.at(x, y, 3) < 8) continue;
      ASSERT_NEAR(large.at(x, y, 0), 250, 12) << x << " " << y;
      ASSERT_NEAR(large.at(x, y, 2), 60, 12) << x << " " << y;
    }
  }
}

/// Root mean square of how far the outline of a disc, drawn sharply at 8x, is from the circle, in pixels of
/// the picture. @param part of the circle, in the middle of which is the direction of x.
double outline_error(const document::FrameModel& model, Vec2 centre, double radius, double part = 1) {
  const image::Image large = rendered(model, {.width = 8 * 120, .height = 8 * 90, .antialias = false});
  double sum = 0;
  constexpr int kRays = 360;
  for (int i = 0; i < kRays; ++i) {
    const double angle = part * 2 * 3.14159265358979 * (static_cast<double>(i) / kRays - 0.5);
    double r = 0;
    const auto is_disc = [&](double at) {
      const Vec2 p = 8 * (centre + Vec2{at * std::cos(angle), at * std::sin(angle)});
      return large.at(static_cast<int>(p.x), static_cast<int>(p.y), 0) > 150;
    };
    while (r < 2 * radius && is_disc(r)) r += 1.0 / 16;
    sum += (r - radius) * (r - radius);
  }
  return std::sqrt(sum / kRays);
}

/// Fairing would draw them back, coarse polylines would cut them off.
TEST(Vectorize, StrokesKeepTheirEnds) {
  for (const double radius : {2.0, 3.0}) {
    const Vec2 end{80.3, 44.6};
    const image::Image picture = draw(120, 90, 1, [&](double x, double y) -> Colour {
      const double along = std::clamp(x, 30.0, end.x);
      return {std::hypot(x - along, y - end.y) < radius ? 230.0 : 20.0};
    });
    const document::FrameModel model = vectorize_picture(picture).model;
    ASSERT_FALSE(model.space->mesh().segments.empty());
    EXPECT_LT(outline_error(model, end, radius, 0.5), 0.2) << radius;
  }
}

/// Knots of features within some pixels of a place.
std::size_t feature_knots(const document::FrameModel& model, Vec2 centre, double reach) {
  std::size_t count = 0;
  for (const mesh::FeatureSegment& s : model.space->mesh().segments) {
    for (const mesh::KnotIndex k : s.knots)
      count += norm(model.space->mesh().knots[k].position - centre) < reach ? 1 : 0;
  }
  return count;
}

TEST(Vectorize, SmallLettersAreLeftToTheSurfaceInVideos) {
  const Vec2 small{100.2, 20.3};
  const Vec2 large{45.4, 50.1};
  const image::Image picture = draw(120, 90, 3, [&](double x, double y) -> Colour {
    const Vec2 p{x, y};
    return norm(p - small) < 4.5 || norm(p - large) < 25 ? Colour{230, 220, 210} : Colour{20, 30, 60};
  });
  const Options still{.max_control_points = 1000};
  const document::FrameModel of_still = vectorize_picture(picture, still).model;
  EXPECT_GT(feature_knots(of_still, small, 8), 3U);
  EXPECT_GT(feature_knots(of_still, large, 30), 3U);
  const document::FrameModel of_video = vectorize_picture(picture, video_options(still)).model;
  EXPECT_EQ(feature_knots(of_video, small, 8), 0U);
  EXPECT_GT(feature_knots(of_video, large, 30), 3U);
}

TEST(Vectorize, DiscsStayRoundWhenEnlarged) {
  for (const double radius : {9.0, 16.0, 30.0}) {
    for (const Preset preset : {Preset::kFast, Preset::kBalanced, Preset::kFine}) {
      const Vec2 centre{60.3, 44.6};
      const image::Image picture = draw(120, 90, 3, [&](double x, double y) -> Colour {
        const bool inside = std::hypot(x - centre.x, y - centre.y) < radius;
        return inside ? Colour{230, 200, 120, 0} : Colour{60 + 0.3 * x, 90, 140 - 0.3 * y, 0};
      });
      const Vectorization v = vectorize_picture(picture, preset_options(preset));
      EXPECT_EQ(v.report.chains, 1U);
      EXPECT_LT(outline_error(v.model, centre, radius), 0.15) << radius << ' ' << static_cast<int>(preset);
    }
  }
}

TEST(Vectorize, ThinLinesHaveColoursOfTheirOwn) {
  const image::Image picture = draw(80, 60, 3, [](double x, double y) -> Colour {
    const double d = std::abs(x - 30 - 0.3 * y);
    return d < 1.5            ? Colour{240, 30, 30, 0}
           : x < 30 + 0.3 * y ? Colour{20, 20, 120, 0}
                              : Colour{20, 140, 20, 0};
  });
  const Vectorization v = vectorize_picture(picture);
  expect_sound(v, picture);
  EXPECT_GT(v.report.chains, 1U);
  EXPECT_GT(psnr(picture, v.model), 30);
  const image::Image large = rendered(v.model, {.width = 640, .height = 480});
  // On the line, and two pixels beside it on both sides.
  EXPECT_NEAR(large.at(8 * 39, 240, 0), 240, 30);
  EXPECT_NEAR(large.at(8 * 36, 240, 2), 120, 25);
  EXPECT_NEAR(large.at(8 * 42, 240, 1), 140, 25);
}

TEST(Vectorize, SmoothPicturesKeepTheIdentity) {
  const image::Image picture = draw(
      96, 64, 1, [](double x, double y) { return Colour{128 + 60 * std::sin(x / 20) * std::cos(y / 15)}; });
  const Vectorization v = vectorize_picture(picture);
  expect_sound(v, picture);
  EXPECT_EQ(v.report.chains, 0U);
  for (const Vec2 d : v.model.displacement) EXPECT_EQ(d, Vec2{});
  EXPECT_GT(psnr(picture, v.model), 45);
}

TEST(Vectorize, RoundsEndWhenThePictureIsMet) {
  const image::Image picture = draw(64, 64, 3, [](double x, double y) { return Colour{x, y, x + y, 0}; });
  const Vectorization v = vectorize_picture(picture);
  ASSERT_EQ(v.report.rounds.size(), 3U);  // round 1, descent, final
  EXPECT_LT(v.report.rounds.front().mec, 0.1);
  EXPECT_LT(v.report.rounds.front().knots, 12U);
}

/// The largest root mean square error of the blocks of 16x16 pixels.
double worst_block(const image::Image& picture, const document::FrameModel& model) {
  const image::Image drawn = rendered(model);
  double worst = 0;
  for (int y = 0; y + 16 <= picture.height; y += 16) {
    for (int x = 0; x + 16 <= picture.width; x += 16) {
      double sum = 0;
      for (int i = 0; i < 256; ++i) {
        for (int c = 0; c < picture.channels; ++c) {
          const double d = picture.at(x + i % 16, y + i / 16, c) - drawn.at(x + i % 16, y + i / 16, c);
          sum += d * d;
        }
      }
      worst = std::max(worst, std::sqrt(sum / 256));
    }
  }
  return worst;
}

/// A soft spot on a ground so smooth that the mean error is small without it.
image::Image soft_spot(double waves) {
  return draw(320, 240, 3, [=](double x, double y) {
    const double spot = 50 / (1 + std::exp((std::hypot(x - 200, y - 150) - 12) / 1.5)) +
                        waves * std::sin(0.5 * x) * std::sin(0.6 * y);
    return Colour{90 + 0.1 * x + spot, 100 + spot, 150 - 0.1 * y - spot};
  });
}

TEST(Vectorize, NothingIsLeftOutWhereTheRestIsEasy) {
  const image::Image picture = soft_spot(0);
  Options options;
  const Vectorization v = vectorize_picture(picture, options);
  EXPECT_EQ(v.report.chains, 0U) << "this is about what is smooth";
  EXPECT_LT(worst_block(picture, v.model), options.mec * options.block_error);
  EXPECT_LT(v.report.rounds.back().control_points, most_control_points(options, picture) / 2)
      << "the rest is easy";
  options.block_error = 0;
  const Vectorization by_mean = vectorize_picture(picture, options);
  EXPECT_LE(by_mean.report.rounds.back().mec, options.mec);
  EXPECT_GT(worst_block(picture, by_mean.model), 2 * options.mec * Options{}.block_error);
  EXPECT_GT(v.report.rounds.front().knots, by_mean.report.rounds.front().knots)
      << "the first ones count, too";
}

/// Small things in rows on flat ground, as lines of text are: without knots in between, faces reach from one
/// row to the next, and what they miss beside a thing is seen all the way.
TEST(Vectorize, DrawingsHaveNoLongEdges) {
  const image::Image picture = draw(260, 200, 3, [](double x, double y) -> Colour {
    const double row = std::fmod(y, 100);
    const double column = std::fmod(x, 13);
    if (row > 20 && row < 29 && std::hypot(column - 6, 1.2 * (row - 24.5)) < 4.5) return {40, 50, 70, 255};
    return {200 + 0.1 * y, 210 + 0.1 * y, 230, 255};
  });
  ASSERT_TRUE(features::is_drawing(picture));
  const auto made = [&](double longest) {
    Options options;
    options.longest_edge = longest;
    return vectorize_picture(picture, options);
  };
  const Vectorization without = made(0);
  const Vectorization with = made(64);
  EXPECT_GT(psnr(picture, with.model), psnr(picture, without.model) + 1);
  EXPECT_LT(double(with.model.space->function_count()), 1.05 * double(without.model.space->function_count()));
}

TEST(Vectorize, PhotographsMayHaveLongEdges) {
  image::Image picture = still_life(96, 72);
  std::mt19937 random(17);
  for (float& sample : picture.samples) sample += static_cast<float>(random() % 9);
  ASSERT_FALSE(features::is_drawing(picture));
  Options options;
  options.longest_edge = 0;
  EXPECT_EQ(vectorize_picture(picture, options).model.colour, vectorize_picture(picture).model.colour);
}

TEST(Vectorize, OnceTheMeanIsMetKnotsGoToWhatIsLeftOutOnly) {
  const image::Image picture = soft_spot(1.5);
  Options options;
  options.block_error = 1.6;
  options.fine_grid = FineGrid::kNone;
  const Vectorization v = vectorize_picture(picture, options);
  const auto used = [&](std::size_t round) {
    return static_cast<double>(v.report.rounds[round].control_points);
  };
  ASSERT_EQ(v.report.rounds[1].name, "round 2");
  EXPECT_LE(v.report.rounds[0].mec, options.mec);
  EXPECT_LT(used(1), 1.8 * used(0));
}

TEST(Vectorize, FaintShapesAreFeaturesOfDrawings) {
  const auto scene = [](double noise) {
    return draw(160, 120, 3, [=](double x, double y) {
      const double disc = std::hypot(x - 80, y - 60) < 40 ? 10 : 0;
      const double grain = noise * std::sin(70.1 * std::floor(x) + 13.7 * std::floor(y) * std::floor(x));
      return Colour{120 + disc + grain, 130 - disc + grain, 140 + grain};
    });
  };
  EXPECT_EQ(vectorize_picture(scene(0)).report.chains, 1U);
  EXPECT_EQ(vectorize_picture(scene(4)).report.chains, 0U) << "grain, so it is no drawing";
  Options options;
  options.drawn_threshold = 0;
  EXPECT_EQ(vectorize_picture(scene(0), options).report.chains, 0U);
}

TEST(Vectorize, TheFirstRoundTakesItsShareOfTheControlPoints) {
  const image::Image picture = still_life(120, 90);
  for (const double share : {0.5, 0.9, 1.0}) {
    const Options options{
        .mec = 0, .rounds = 3, .max_control_points = 600, .first_share = share, .features = false};
    const Vectorization v = vectorize_picture(picture, options);
    EXPECT_NEAR(static_cast<double>(v.report.rounds.front().control_points), share * 600, 60) << share;
    for (const RoundReport& round : v.report.rounds) EXPECT_LE(round.control_points, 600U) << share;
  }
}

/// Six disks, on a ground that is smooth or one of fine waves.
image::Image disks(bool waves) {
  return draw(240, 160, 1, [&](double x, double y) {
    double value = 90 + 0.1 * x + (waves ? 30 * std::sin(1.1 * x) * std::sin(0.9 * y) : 0);
    for (int i = 0; i < 6; ++i) {
      const double inside = 14.5 - std::hypot(x - 40 - 80 * (i % 3), y - 40 - 80 * (i / 3));
      value += (220 - value) * std::clamp(inside, 0.0, 1.0);
    }
    return Colour{value};
  });
}

TEST(Vectorize, FeaturesMayHaveMoreThanTheirShareOfWhatIsLeft) {
  Options options{.max_control_points = 2000};
  options.feature_share = 0.04;
  const Vectorization calm = vectorize_picture(disks(false), options);
  EXPECT_EQ(calm.report.chains, 6U);
  EXPECT_EQ(calm.report.chains_over_budget, 0U);
  EXPECT_GT(psnr(disks(false), calm.model), 40);
  options.max_control_points = 700;
  const Vectorization busy = vectorize_picture(disks(true), options);
  EXPECT_GT(busy.report.chains_over_budget, 0U);
}

TEST(Vectorize, AnySizeAndAnyChannels) {
  constexpr std::pair<int, int> kSizes[] = {{1, 1}, {1, 7}, {9, 1}, {2, 2}, {3, 3}, {2, 40}, {17, 13}};
  for (const auto& [width, height] : kSizes) {
    for (int channels = 1; channels <= 4; ++channels) {
      SCOPED_TRACE(::testing::Message() << width << " x " << height << " x " << channels);
      const image::Image picture = test::random_8bit_picture(width, height, channels, 5);
      const Vectorization v = vectorize_picture(picture);
      expect_sound(v, picture);
      if (picture.pixel_count() <= 9) {
        EXPECT_GT(psnr(picture, v.model), 12);
      }
    }
  }
}

class BoundOnControlPoints : public ::testing::TestWithParam<int> {};

TEST_P(BoundOnControlPoints, HoldsForPicturesThatAreAllEdges) {
  const int kind = GetParam();
  image::Image picture = test::random_8bit_picture(100, 80, 3, 7);  // noise
  if (kind == 1) {                                                  // hatching
    picture = draw(100, 80, 3, [](double x, double y) {
      return std::fmod(x + 0.5 * y, 5) < 2.5 ? Colour{250, 250, 250, 0} : Colour{10, 10, 10, 0};
    });
  }
  if (kind == 2) {  // little squares, like text
    picture = draw(100, 80, 3, [](double x, double y) {
      return std::fmod(x, 11) < 6 && std::fmod(y, 13) < 8 ? Colour{0, 0, 0, 0} : Colour{255, 255, 255, 0};
    });
  }
  if (kind == 3) {  // line art
    picture = draw(160, 120, 3, [](double x, double y) {
      return std::fmod(std::hypot(x - 70, y - 66), 16) < 5 ? Colour{0, 0, 0, 0} : Colour{255, 255, 255, 0};
    });
  }
  for (const std::size_t bound : {60U, 300U, 1000U, 1600U}) {
    Options options;
    options.max_control_points = bound;
    const Vectorization v = vectorize_picture(picture, options);
    expect_sound(v, picture);
    EXPECT_LE(v.model.space->function_count(), bound);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, BoundOnControlPoints, ::testing::Values(0, 1, 2, 3));

TEST(Vectorize, LineArtKeepsAllItsLinesIfTheyFit) {
  const image::Image picture = draw(240, 180, 3, [](double x, double y) {
    const bool on_line = std::fmod(x + 0.2 * y, 20) < 4 && y > 15 && y < 165;
    return on_line ? Colour{0, 0, 0, 0} : Colour{255, 255, 255, 0};
  });
  Options options;
  options.max_control_points = 10000;
  const Vectorization all = vectorize_picture(picture, options);
  EXPECT_EQ(all.report.chains_over_budget, 0U);
  // Within the bound, but more than the share that features have otherwise.
  const std::size_t needed = all.model.space->function_count();
  options.max_control_points = needed * 5 / 4;
  const Vectorization some = vectorize_picture(picture, options);
  EXPECT_EQ(some.report.chains_over_budget, 0U);
  EXPECT_EQ(some.report.chains, all.report.chains);
  EXPECT_LE(some.model.space->function_count(), options.max_control_points);
  EXPECT_GT(psnr(picture, some.model), psnr(picture, all.model) - 1);
  // Far too few: the report is of what is kept, not of what was tried.
  options.max_control_points = needed / 3;
  const Vectorization few = vectorize_picture(picture, options);
  EXPECT_GT(few.report.chains_over_budget, 0U);
  EXPECT_EQ(few.report.chains, all.report.chains);
  EXPECT_LE(few.report.feature_share, 1);
  EXPECT_TRUE(few.report.strong_over_budget);
}

/// A third of it full of rings, the rest empty.
image::Image dense_page(int width, int height) {
  return draw(width, height, 3, [=](double x, double y) {
    const double r = std::hypot(std::fmod(x, 11) - 5.5, std::fmod(y, 11) - 5.5);
    const bool on_ring = x < width / 3.0 && r > 2.4 && r < 4.2;
    return on_ring ? Colour{20, 30, 40, 0} : Colour{255, 255, 255, 0};
  });
}

TEST(Vectorize, TheBoundGrowsWhereFeaturesOfDrawingsHaveNoRoom) {
  const image::Image page = dense_page(240, 180);
  const std::size_t usual = default_control_points(page);
  const std::size_t most = default_control_points_with_features(page);
  ASSERT_EQ(most, std::size_t{240} * 180 * 2 / 5);
  ASSERT_LT(usual, most / 2);
  const Vectorization grown = vectorize_picture(page);
  EXPECT_EQ(grown.report.max_control_points, most);
  EXPECT_EQ(grown.report.chains_over_budget, 0U);
  EXPECT_LE(grown.model.space->function_count(), most);
  expect_sound(grown, page);
  // Not one that is given, and not where that is not wanted.
  const Vectorization given = vectorize_picture(page, {.max_control_points = usual});
  EXPECT_EQ(given.report.max_control_points, usual);
  EXPECT_GT(given.report.chains_over_budget, 0U);
  EXPECT_GT(psnr(page, grown.model), psnr(page, given.model) + 3);
  const Vectorization fixed = vectorize_picture(page, {.room_for_features = false});
  EXPECT_TRUE(fixed.model.colour == given.model.colour);
}

image::Image noise_picture(int width, int height) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> noise(0, 255);
  image::Image picture = image::make_image(width, height, 1);
  for (float& sample : picture.samples) sample = noise(random);
  return picture;
}

/// A window of stained glass, with noise: panes of all colours between bars.
image::Image glass(int width, int height, int pane) {
  std::mt19937 random(5);
  std::vector<Colour> colours(1000);
  for (Colour& colour : colours)
    for (double& c : colour) c = 120 + double(random() % 120);
  image::Image picture = draw(width, height, 3, [&](double x, double y) {
    const bool on_bar = std::fmod(x, pane) < 4 || std::fmod(y, pane) < 4;
    return on_bar ? Colour{20, 20, 30, 0} : colours[std::size_t(x / pane) * 31 + std::size_t(y / pane)];
  });
  std::normal_distribution<float> noise(0, 4);
  for (float& sample : picture.samples) sample += noise(random);
  return picture;
}

TEST(Vectorize, TheBoundGrowsWherePhotographsLoseStrongFeatures) {
  const image::Image window = glass(320, 240, 12);
  ASSERT_FALSE(features::is_drawing(window));
  ASSERT_EQ(features::caption_pixels(window), 0U);
  const Vectorization grown = vectorize_picture(window);
  EXPECT_EQ(default_control_points(window), 3000U);
  EXPECT_EQ(grown.report.max_control_points, 320U * 240 / 10);
  EXPECT_GT(grown.model.space->function_count(), 5000U);
  EXPECT_LE(grown.model.space->function_count(), 320U * 240 / 10);
}

TEST(Vectorize, TheBoundStaysWhereFeaturesHaveRoom) {
  const image::Image drawing = draw(300, 200, 3, [](double x, double y) {
    return std::hypot(x - 110, y - 86) < 60 ? Colour{0, 0, 0, 0} : Colour{255, 255, 255, 0};
  });
  EXPECT_EQ(vectorize_picture(drawing).report.max_control_points, default_control_points(drawing));
}

TEST(Vectorize, BoundsBeyondAllPicturesAreTheSame) {
  const image::Image picture = noise_picture(40, 30);
  const auto control_points = [&](std::size_t most) {
    return vectorize_picture(picture, {.degree = 1, .rounds = 1, .max_control_points = most})
        .model.space->function_count();
  };
  EXPECT_EQ(control_points(std::numeric_limits<std::size_t>::max()), control_points(1'000'000));
}

TEST(Vectorize, DrawingsMayHaveMoreControlPoints) {
  const image::Image drawing = draw(300, 200, 3, [](double x, double y) {
    return std::hypot(x - 110, y - 86) < 60 ? Colour{0, 0, 0, 0} : Colour{255, 255, 255, 0};
  });
  EXPECT_EQ(default_control_points(drawing), 6000U);
  EXPECT_EQ(default_control_points(image::make_image(2000, 1500, 1)), 200000U);
  EXPECT_EQ(default_control_points(image::make_image(4000, 2000, 1)), 220000U);
  EXPECT_EQ(default_control_points(noise_picture(300, 200)), 3000U);
}

TEST(Vectorize, DenseDrawingsMayHaveEvenMore) {
  // Bars of one pixel every so many rows; three rows in so many are not flat.
  const auto bars = [](int distance) {
    return draw(400, 300, 1, [=](double, double y) { return Colour{int(y) % distance == 0 ? 0.0 : 255.0}; });
  };
  const std::size_t sparse = default_control_points(bars(20));
  const std::size_t dense = default_control_points(bars(8));
  EXPECT_EQ(sparse, 12000U);
  EXPECT_NEAR(double(dense), (2 * 3.0 / 8 - 0.4) * 400 * 300, 1200);
  EXPECT_EQ(default_control_points(bars(6)), 12000U) << "half of it is not flat";
  EXPECT_EQ(default_control_points_with_features(bars(6)), 48000U);
  EXPECT_EQ(default_control_points_with_features(image::make_image(1000, 800, 1)), 200000U);
  EXPECT_EQ(default_control_points_with_features(image::make_image(4000, 2000, 1)), 220000U);
}

/// Dots on a grid that is as wide as told, all of them a little off its points.
image::Image dots(int width, int height, int distance) {
  return draw(width, height, 1, [=](double x, double y) {
    const double u = std::floor(x / distance), v = std::floor(y / distance);
    const double a = u * 0.37 + v * 0.73, off = 0.3 * distance;
    const double dx = x - (u + 0.5) * distance - off * std::sin(9 * a);
    const double dy = y - (v + 0.5) * distance - off * std::cos(7 * a);
    return Colour{255 * std::clamp(std::hypot(dx, dy) - 0.8, 0.0, 1.0)};
  });
}

TEST(Vectorize, TheBoundGrowsWhereMarksThatAreNoFeaturesCannotBeRead) {
  const image::Image stipple = dots(240, 180, 8);
  ASSERT_TRUE(features::is_drawing(stipple));
  const std::size_t usual = default_control_points(stipple);
  ASSERT_GT(default_control_points_with_features(stipple), 2 * usual);
  const Vectorization made = vectorize_picture(stipple);
  EXPECT_EQ(made.report.max_control_points, default_control_points_with_features(stipple));
  EXPECT_GT(made.report.rounds.back().psnr, 32);
  Options given;
  given.max_control_points = usual;
  const Vectorization bounded = vectorize_picture(stipple, given);
  EXPECT_LE(bounded.model.space->function_count(), usual);
  EXPECT_LT(bounded.report.rounds.back().psnr, 32);
  Options usual_only;
  usual_only.room_for_features = false;
  EXPECT_EQ(vectorize_picture(stipple, usual_only).report.max_control_points, usual);
}

TEST(Vectorize, PhotographsWithCaptionsMayHaveMoreControlPoints) {
  image::Image photograph = noise_picture(400, 300);
  for (float& sample : photograph.samples) sample = 100 + sample / 8;
  EXPECT_EQ(default_control_points(photograph), 3300U);
  // Strokes of three pixels, both ways, on a part of it.
  const auto write = [&](int rows) {
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < 400; ++x) photograph.at(x, y, 0) = x % 9 < 3 || y % 9 < 3 ? 255 : 20;
  };
  write(16);
  const std::size_t captions = features::caption_pixels(photograph);
  ASSERT_GT(captions, 1000U);
  EXPECT_EQ(default_control_points(photograph), 3300U + captions);
  EXPECT_EQ(with_captions(photograph, 2000, 2500), 2500U);
  EXPECT_EQ(with_captions(photograph, 2000, 1000), 2000U);
  write(100);
  ASSERT_FALSE(features::is_drawing(photograph));
  EXPECT_EQ(default_control_points(photograph), 12000U) << "10 % of the pixels";
}

TEST(Vectorize, SmallVideosMayHaveMoreControlPoints) {
  EXPECT_EQ(default_video_control_points(640 * 360), 4608U);
  EXPECT_EQ(default_video_control_points(200 * 100), 1500U);
  EXPECT_EQ(default_video_control_points(50 * 40), 400U);
  EXPECT_EQ(default_video_control_points(20 * 10), 256U);
  EXPECT_EQ(default_drawn_video_control_points(200 * 100), 3000U);
  EXPECT_EQ(default_drawn_video_control_points(100 * 60), 1200U);
  EXPECT_EQ(default_drawn_video_control_points(20 * 10), 256U);
  EXPECT_EQ(default_drawn_video_control_points(640 * 360), default_video_control_points(640 * 360));
  EXPECT_EQ(default_dense_video_control_points(640 * 360), 23040U);
  EXPECT_EQ(default_dense_video_control_points(200 * 100), 3000U);
  EXPECT_EQ(default_dense_video_control_points(4000 * 3000), 240000U) << "2 % are more than 200,000";
  EXPECT_EQ(default_dense_drawn_video_control_points(640 * 360), 46080U);
  EXPECT_EQ(default_dense_drawn_video_control_points(854 * 480), 50000U);
  EXPECT_EQ(default_cramped_video_control_points(640 * 360), 69120U);
  EXPECT_EQ(default_cramped_video_control_points(854 * 480), 75000U);
  EXPECT_EQ(default_cramped_video_control_points(1280 * 720), 92160U);
  EXPECT_EQ(default_dense_drawn_video_control_points(1280 * 720), 92160U);
}

TEST(Vectorize, SmallPicturesMayHaveMoreControlPoints) {
  EXPECT_EQ(default_control_points(noise_picture(400, 300)), 3300U);
  EXPECT_EQ(default_control_points(noise_picture(300, 300)), 3000U);
  EXPECT_EQ(default_control_points(noise_picture(100, 60)), 1200U);
  EXPECT_EQ(default_control_points(noise_picture(20, 10)), 256U);
  // Drawings too, as a picture of one colour is.
  EXPECT_EQ(default_control_points(image::make_image(100, 60, 3)), 1200U);
}

TEST(Vectorize, AllDegrees) {
  const image::Image picture = still_life(90, 70);
  for (int degree = 1; degree <= 3; ++degree) {
    Options options;
    options.degree = degree;
    options.max_control_points = 400;
    const Vectorization v = vectorize_picture(picture, options);
    expect_sound(v, picture);
    EXPECT_EQ(v.model.space->degree(), degree);
    EXPECT_LE(v.model.space->function_count(), 400U);
    EXPECT_GT(psnr(picture, v.model), 30) << degree;
  }
}

TEST(Vectorize, ModelsAreFittedToTheGeometryThatIsStored) {
  const image::Image picture = still_life(90, 70);
  for (int degree = 1; degree <= 3; ++degree) {
    Options options;
    options.degree = degree;
    options.max_control_points = 400;
    const document::FrameModel model = vectorize_picture(picture, options).model;
    ASSERT_FALSE(model.space->mesh().segments.empty());
    std::ostringstream out;
    document::SequenceInfo info;
    info.width = picture.width;
    info.height = picture.height;
    info.degree = degree;
    document::Writer writer(out, info);
    const document::FrameModel stored = writer.append(model);
    EXPECT_EQ(stored.space, model.space) << degree;
    EXPECT_EQ(stored.displacement, model.displacement) << degree;
  }
}

TEST(Vectorize, ReportsAndShowsEveryStage) {
  const image::Image picture = still_life(90, 70);
  std::vector<std::string> stages;
  Options options{.max_control_points = 1000};  // enough for the features that are found at first
  options.fine_grid = FineGrid::kNone;
  const Vectorization v = vectorize_picture(picture, options, [&](const Progress& p) {
    stages.push_back(p.stage);
    EXPECT_EQ(p.picture, &picture);
    if (p.stage == "parametrization") {
      EXPECT_TRUE(p.detected && p.faired && p.corrected && p.image_mesh && p.parametrization);
      EXPECT_EQ(p.parametrization->parameter.size(), picture.pixel_count());
    }
    if (p.stage == "knots") {
      EXPECT_TRUE(p.detected && p.faired && p.corrected && p.knot_mesh);
      EXPECT_FALSE(p.image_mesh || p.parametrization);
    }
    if (p.stage == "final") {
      EXPECT_TRUE(p.model && p.residual);
    }
  });
  const std::vector<std::string> first{"features",        "fairing", "correction",
                                       "parametrization", "knots",   "round 1"};
  ASSERT_GE(stages.size(), first.size());
  EXPECT_TRUE(std::equal(first.begin(), first.end(), stages.begin()));
  EXPECT_EQ(stages.back(), "final");
  const RoundReport& last = v.report.rounds.back();
  EXPECT_EQ(last.control_points, v.model.space->function_count());
  EXPECT_EQ(last.knots, v.model.space->mesh().knots.size());
  EXPECT_EQ(last.raw_bytes, document::raw_accounting_bytes(v.model));
}

TEST(Vectorize, StrokesOfTwoPixelsAreDrawnAsTheyAre) {
  // Every pixel of a stroke is crossed by one of its two curves.
  const image::Image strokes = draw(160, 120, 1, [](double x, double y) {
    const double line = std::abs(y - 20 - 0.2 * x);
    const double wave = std::abs(y - 90 - 12 * std::sin(x / 20));
    const double ring = std::abs(std::hypot(x - 100, y - 62) - 14);
    return Colour{std::min({line, wave, ring}) < 1 ? 20.0 : 240.0};
  });
  Options options;
  const double with = psnr(strokes, vectorize_picture(strokes, options).model);
  options.mixed_weight = 0;
  const double without = psnr(strokes, vectorize_picture(strokes, options).model);
  EXPECT_GT(with, without + 3);
}

TEST(Vectorize, DrawingsHaveFinerPolylinesIfTheyFit) {
  const auto discs = [](double radius, bool soft) {
    return draw(200, 150, 3, [=](double x, double y) {
      if (!soft) x = std::floor(x) + 0.5, y = std::floor(y) + 0.5;
      const double u = std::fmod(x, 50) - 25;
      const double v = std::fmod(y, 50) - 25;
      return std::hypot(u, v) < radius ? Colour{30, 60, 90} : Colour{230, 220, 200};
    });
  };
  const auto vertices = [](const image::Image& picture, double distance, std::size_t bound) {
    Options options;
    options.drawn_distance = distance;
    options.max_control_points = bound;
    return vectorize_picture(picture, options).report.polyline_vertices;
  };
  const image::Image soft = discs(18.3, true);
  EXPECT_GT(vertices(soft, 0.35, 9000), vertices(soft, 1, 9000));
  EXPECT_EQ(vertices(soft, 0.35, 500), vertices(soft, 1, 500)) << "where they do not fit";
  const image::Image hard = discs(18.3, false);
  EXPECT_EQ(vertices(hard, 0.15, 9000), vertices(hard, 1, 9000)) << "which are known to half a pixel only";
  Options options;
  options.drawn_distance = 0.7;
  EXPECT_GE(video_options(options).drawn_distance, video_options(options).parametrize.polyline_distance);
}

TEST(Vectorize, EdgesOfDrawingsMayBeOfAnySoftnessIfThatIsSaid) {
  const image::Image soft = draw(120, 90, 1, [](double x, double y) {
    return Colour{255 * std::clamp((std::hypot(x - 60, y - 45) - 24) / 12, 0.0, 1.0)};
  });
  ASSERT_TRUE(features::is_drawing(soft));
  Options options = preset_options(Preset::kFine);
  options.fine_grid = FineGrid::kNone;
  EXPECT_EQ(vectorize_picture(soft, options).report.chains, 0U);
  options.detect.max_blur = 0;
  EXPECT_GT(vectorize_picture(soft, options).report.chains, 0U);
}

TEST(Vectorize, CornersStaySharpWhenEnlarged) {
  // A square that is turned, with a triangle before it, at one scale and another.
  const auto drawn = [](double scale) {
    return draw(int(120 * scale), int(100 * scale), 3, [=](double x, double y) {
      x /= scale, y /= scale;
      const double u = 0.9 * (x - 55) + 0.436 * (y - 50);
      const double v = -0.436 * (x - 55) + 0.9 * (y - 50);
      if (y > 30 && y + 1.9 * x < 210 && y - 0.4 * x < 25) return Colour{200, 40, 60};
      return std::max(std::abs(u), std::abs(v)) < 29.3 ? Colour{30, 90, 160} : Colour{240, 235, 220};
    });
  };
  const image::Image picture = drawn(1);
  const image::Image large = drawn(4);
  const auto psnr_of = [&](const Options& options, std::size_t& corners) {
    const Vectorization v = vectorize_picture(picture, options);
    corners = v.report.corners;
    return image::compare_images(large, rendered(v.model, {.width = large.width, .height = large.height}))
        .psnr;
  };
  Options options;
  std::size_t corners = 0;
  const double with = psnr_of(options, corners);
  EXPECT_GE(corners, 6U);
  options.corner_detection = false;
  const double without = psnr_of(options, corners);
  EXPECT_EQ(corners, 0U);
  EXPECT_GT(with, without + 2);
}

TEST(Vectorize, VideosHaveNoCornersOfTheirOwn) {
  EXPECT_TRUE(Options{}.corner_detection);
  EXPECT_FALSE(video_options({}).corner_detection);
  EXPECT_FALSE(video_options({}).clear_curves);
  EXPECT_GT(Options{}.drawn_weak_share, Options{}.weak_share);
  EXPECT_EQ(video_options({}).drawn_weak_share, video_options({}).weak_share);
}

TEST(Vectorize, FramesOfVideosAreNotFittedToMixedPixels) {
  EXPECT_GT(Options{}.mixed_weight, 0);
  EXPECT_EQ(video_options({}).mixed_weight, 0);
}

TEST(VideoOptions, DrawnFramesHaveWhatPicturesHaveButForNoiseAndWeakFeatures) {
  Options picture;
  picture.mec = 1.5;
  const Options drawn = drawn_video_options(picture);
  EXPECT_TRUE(drawn.corner_detection);
  EXPECT_TRUE(drawn.clear_curves);
  EXPECT_FALSE(drawn.clear_inside);
  EXPECT_EQ(drawn.longest_edge, picture.longest_edge);
  EXPECT_EQ(video_options(picture).longest_edge, 0) << "of film";
  EXPECT_EQ(drawn.mixed_weight, picture.mixed_weight);
  EXPECT_EQ(drawn.feature_share, picture.feature_share);
  EXPECT_FALSE(drawn.room_for_features);
  EXPECT_EQ(drawn.mec, 1.5);
  EXPECT_EQ(drawn.drawn_threshold, picture.drawn_threshold);
  EXPECT_GT(drawn.noisy_smoothing, drawn.fine_smoothing) << "codecs leave faint traces";
  EXPECT_EQ(drawn.drawn_weak_share, picture.feature_share) << "whether a feature is weak changes";
}

TEST(Vectorize, FeaturesThatCannotBeStoredAreGivenUp) {
  const image::Image picture = still_life(60, 45);
  int finals = 0;
  const Vectorization v = vectorize_picture(picture, {}, [&](const Progress& progress) {
    if (progress.stage == "final" && ++finals == 1)
      throw document::FlatFace("cannot store a frame: for a test");
  });
  EXPECT_EQ(finals, 2);
  EXPECT_TRUE(v.report.features_dropped);
  EXPECT_TRUE(v.model.space->mesh().segments.empty());
  EXPECT_GT(psnr(picture, v.model), 20);
  const auto always = [](const Progress&) { throw document::FlatFace("cannot store a frame: for a test"); };
  EXPECT_THROW(vectorize_picture(picture, {}, always), document::FlatFace);
}

TEST(Vectorize, StopsWhenTheObserverThrows) {
  const image::Image picture = still_life(60, 50);
  EXPECT_THROW(vectorize_picture(picture, {},
                                 [](const Progress&) { throw Error(ErrorKind::kInterrupted, "stopped"); }),
               Error);
}

TEST(Vectorize, RefusesOptionsOutOfRange) {
  const image::Image picture = still_life(20, 20);
  Options options;
  options.degree = 4;
  EXPECT_THROW(vectorize_picture(picture, options), Error);
  options = {};
  options.rounds = 0;
  EXPECT_THROW(vectorize_picture(picture, options), Error);
  EXPECT_THROW(vectorize_picture(image::Image{}, {}), Error);
  EXPECT_THROW(vectorize_picture(image::Image{20, 20, 3, std::vector<float>(50)}, {.features = false}),
               Error);

  const auto refuses = [&](auto change) {
    Options changed = preset_options(Preset::kFast);
    change(changed);
    try {
      vectorize_picture(picture, changed);
    } catch (const Error& e) {
      return e.kind() == ErrorKind::kInvalidArgument;
    }
    return false;
  };
  const double nan = std::nan("");
  EXPECT_FALSE(refuses([](Options&) {}));
  EXPECT_TRUE(refuses([](Options& o) { o.knot_bits = 15; }));
  EXPECT_TRUE(refuses([](Options& o) { o.knot_bits = -1; }));
  EXPECT_TRUE(refuses([](Options& o) { o.displacement_step = 0; }));
  EXPECT_TRUE(refuses([](Options& o) { o.displacement_step = 17; }));
  EXPECT_TRUE(refuses([&](Options& o) { o.displacement_step = nan; }));
  EXPECT_TRUE(refuses([](Options& o) { o.segment_knot_spacing = 0; }));
  EXPECT_TRUE(refuses([&](Options& o) { o.segment_knot_spacing = nan; }));
  EXPECT_TRUE(refuses([](Options& o) { o.feature_share = 1.5; }));
  EXPECT_TRUE(refuses([](Options& o) { o.weak_share = 1.5; }));
  EXPECT_TRUE(refuses([](Options& o) { o.drawn_weak_share = -1; }));
  EXPECT_TRUE(refuses([&](Options& o) { o.drawn_weak_share = nan; }));
  EXPECT_TRUE(refuses([](Options& o) { o.corners.most_error = 0; }));
  EXPECT_TRUE(refuses([](Options& o) { o.block_error = -1; }));
  EXPECT_TRUE(refuses([](Options& o) { o.max_turning = -1; }));
  EXPECT_TRUE(refuses([&](Options& o) { o.block_error = nan; }));
  EXPECT_TRUE(refuses([](Options& o) { o.drawn_threshold = -1; }));
  EXPECT_TRUE(refuses([&](Options& o) { o.drawn_threshold = nan; }));
  EXPECT_TRUE(refuses([](Options& o) { o.first_share = 0; }));
  EXPECT_TRUE(refuses([](Options& o) { o.first_share = 1.5; }));
  EXPECT_TRUE(refuses([&](Options& o) { o.first_share = nan; }));
  EXPECT_TRUE(refuses([](Options& o) { o.descent_steps = -1; }));
  EXPECT_TRUE(refuses([](Options& o) { o.colour.ridge = 0; }));
  EXPECT_TRUE(refuses([](Options& o) { o.colour.step = -1; }));
  EXPECT_TRUE(refuses([](Options& o) { o.drawn_distance = 0; }));
  EXPECT_TRUE(refuses([&](Options& o) { o.drawn_distance = nan; }));
  EXPECT_TRUE(refuses([](Options& o) { o.mixed_weight = -1; }));
  EXPECT_TRUE(refuses([&](Options& o) { o.mixed_weight = nan; }));
  EXPECT_TRUE(refuses([](Options& o) { o.geometry.ridge = 0; }));
  EXPECT_TRUE(refuses([](Options& o) { o.optimise.rounds = -1; }));
  EXPECT_TRUE(refuses([](Options& o) { o.optimise.steps = -1; }));

  for (const float bad : {NAN, INFINITY}) {
    image::Image with_bad = picture;
    with_bad.samples[17] = bad;
    EXPECT_THROW(vectorize_picture(with_bad, preset_options(Preset::kFast)), Error) << bad;
  }
}

}  // namespace
}  // namespace knotreel::vectorize
