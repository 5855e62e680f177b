// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <sstream>
#include <string>

#include "knotreel/base/parallel.h"
#include "knotreel/document/writer.h"
#include "knotreel/features/flat_share.h"
#include "knotreel/fit/geometry_fit.h"
#include "knotreel/raster/render.h"
#include "knotreel/track/tracker.h"
#include "support/drawn_scene.h"
#include "support/pictures.h"
#include "support/rounds.h"
#include "track/cold_frame.h"
#include "track/drawn_features.h"
#include "track/quality.h"

namespace knotreel::track {
namespace {

using test::drawing;
using test::drawn_clip;

vectorize::Options picture_options(std::size_t most = 1000) {
  vectorize::Options options = vectorize::group_preset_options(vectorize::Preset::kBalanced);
  options.max_control_points = most;
  return options;
}

TrackOptions drawn_options(std::size_t most = 1000) {
  TrackOptions options;
  options.drawn =
      std::make_shared<const vectorize::Options>(vectorize::drawn_video_options(picture_options(most)));
  return options;
}

struct TrackedDrawing {
  std::vector<document::FrameModel> models;
  std::vector<FrameReport> reports;
  double psnr = 0;  ///< of all frames as drawn
};

TrackedDrawing track_drawing(const std::vector<image::Image>& pictures, const TrackOptions& options,
                             std::size_t most = 1000) {
  Tracker tracker(vectorize::video_options(picture_options(most)), options);
  TrackedDrawing run;
  double squares = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    std::optional<Motion> motion;
    if (i > 0) motion = motion_between(pictures[i - 1], pictures[i]);
    FrameReport report;
    run.models.push_back(tracker.next(pictures[i], motion ? &*motion : nullptr, &report));
    run.reports.push_back(report);
    const std::vector<float> seen = raster::render(run.models.back());
    for (std::size_t s = 0; s < seen.size(); ++s) {
      const double d = std::clamp(double{seen[s]}, 0.0, 255.0) - double{pictures[i].samples[s]};
      squares += d * d;
    }
    count += seen.size();
  }
  run.psnr = 10 * std::log10(255.0 * 255.0 * double(count) / squares);
  return run;
}

std::size_t bytes_of(const TrackedDrawing& run) {
  std::ostringstream out;
  document::SequenceInfo info;
  info.width = 120;
  info.height = 90;
  info.channels = 3;
  document::Writer writer(out, info);
  std::int64_t pts = 0;
  for (document::FrameModel model : run.models) {
    model.pts = pts++;
    writer.append(model);
  }
  writer.finish();
  return out.str().size();
}

TEST(DrawnFrames, AreFarBetterThanAsFilmAndStillWarm) {
  const std::vector<image::Image> pictures = drawn_clip(9);
  const TrackedDrawing drawn = track_drawing(pictures, drawn_options());
  const TrackedDrawing film = track_drawing(pictures, {});
  EXPECT_GT(drawn.psnr, film.psnr + 3);
  EXPECT_GT(drawn.psnr, 42);
  double survival = 0;
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    EXPECT_EQ(drawn.reports[i].start, Start::kWarm) << i;
    survival += drawn.reports[i].survival;
  }
  EXPECT_GT(survival / double(pictures.size() - 1), 0.7);
}

TEST(DrawnFrames, HaveTheFeaturesOfTheirOwnPicture) {
  std::vector<image::Image> pictures{drawing(34, 40), drawing(36, 40)};
  // Another disk appears at once.
  const image::Image other = drawing(90, 20, 52);
  for (std::size_t i = 0; i < other.samples.size(); ++i) {
    const std::size_t x = i / 3 % 120, y = i / 3 / 120;
    if (x > 64 && y < 44) pictures[1].samples[i] = other.samples[i];
  }
  TrackOptions options = drawn_options();
  options.drift = 100;  // it stays a warm frame
  const TrackedDrawing run = track_drawing(pictures, options);
  ASSERT_EQ(run.reports[1].start, Start::kWarm);
  std::size_t near = 0;
  const mesh::KnotMesh& mesh = run.models[1].space->mesh();
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 middle = 0.5 * (mesh.knots[s.knots.front()].position + mesh.knots[s.knots.back()].position);
    near += std::abs(norm(middle - Vec2{90, 20}) - 20) < 1.5 ? 1 : 0;
  }
  EXPECT_GE(near, 5U);
}

/// A dot that moves in a corner of a drawing.
std::vector<image::Image> dot_clip(std::size_t frames) {
  std::vector<image::Image> pictures(frames, drawing(34, 40, 60));
  int left = 100;
  for (image::Image& picture : pictures) {
    for (int y = 2; y < 8; ++y)
      for (int x = left; x < left + 6; ++x)
        for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 10;
    left -= 4;
  }
  return pictures;
}

TEST(DrawnFrames, LookTheSameInTilesThatHaveNotChanged) {
  Tracker tracker(vectorize::video_options(picture_options()), drawn_options());
  const std::vector<image::Image> pictures = dot_clip(14);
  image::Image before;
  std::size_t kept = 0;
  std::size_t all = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    std::optional<Motion> motion;
    if (i > 0) motion = motion_between(pictures[i - 1], pictures[i]);
    const document::FrameModel model = tracker.next(pictures[i], motion ? &*motion : nullptr);
    const image::Image now =
        raster::Renderer(model, {}, std::make_shared<const spline::Basis>(model.space)).whole();
    const std::vector<std::uint8_t> changed = tracker.changed_tiles();
    EXPECT_TRUE(i > 0 || changed.empty());
    all += i > 5 ? std::size_t(15 * 12) : 0;
    for (std::size_t t = 0; t < changed.size(); ++t) {
      if (changed[t]) continue;
      kept += i > 5 ? 1 : 0;
      const int left = int(t % 15) * 8, top = int(t / 15) * 8;
      for (int y = top; y < std::min(top + 8, now.height); ++y)
        for (int x = left; x < left + 8; ++x)
          for (int c = 0; c < 3; ++c) ASSERT_NEAR(now.at(x, y, c), before.at(x, y, c), 0.02) << x << ' ' << y;
    }
    before = now;
  }
  EXPECT_GT(4 * kept, all);
}

TEST(DrawnFrames, StayTheSameWhereNothingChanges) {
  const TrackedDrawing run = track_drawing(dot_clip(12), drawn_options());
  std::size_t same = 0;
  std::size_t below = 0;
  for (std::size_t f = 6; f < 12; ++f) {
    const mesh::KnotMesh& before = run.models[f - 1].space->mesh();
    for (const mesh::Knot& k : run.models[f].space->mesh().knots) {
      if (k.position.y < 15) continue;
      ++below;
      same += std::any_of(before.knots.begin(), before.knots.end(),
                          [&](const mesh::Knot& b) { return b.id == k.id && b.position == k.position; });
    }
  }
  EXPECT_GT(below, 6 * 40U);
  EXPECT_GE(double(same), 0.9 * double(below));
}

TEST(DrawnFrames, DoNotDependOnTheNumberOfThreads) {
  const std::vector<image::Image> pictures = drawn_clip(4);
  const auto with = [&](int threads) {
    const ThreadCap cap(threads);
    return track_drawing(pictures, drawn_options());
  };
  const TrackedDrawing serial = with(1);
  const TrackedDrawing parallel = with(3);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    EXPECT_EQ(serial.models[i].colour, parallel.models[i].colour) << i;
    EXPECT_EQ(serial.models[i].displacement, parallel.models[i].displacement) << i;
  }
}

TEST(DrawnFrames, CanBeStoredAsDeltas) {
  const TrackedDrawing run = track_drawing(drawn_clip(6), drawn_options());
  TrackedDrawing keys = run;
  for (document::FrameModel& model : keys.models) model.keyframe = true;
  EXPECT_LT(double(bytes_of(run)), 0.8 * double(bytes_of(keys)));
}

TEST(DrawnFrames, WhatIsNoDrawingIsFilm) {
  std::vector<image::Image> pictures;
  for (int i = 0; i < 3; ++i) pictures.push_back(test::random_8bit_picture(64, 48, 3, 5));
  for (int i = 1; i < 3; ++i) pictures[std::size_t(i)].at(7 * i, 9, 0) += 3;
  const TrackedDrawing with = track_drawing(pictures, drawn_options(300), 300);
  const TrackedDrawing without = track_drawing(pictures, {}, 300);
  for (std::size_t i = 0; i < pictures.size(); ++i)
    EXPECT_EQ(with.models[i].colour, without.models[i].colour) << i;
}

/// From a drawing to film and back, without a cut.
TEST(DrawnFrames, MayBecomeFilmInTheMidstOfAGroup) {
  std::vector<image::Image> pictures = drawn_clip(6);
  const image::Image grain = test::random_8bit_picture(120, 90, 3, 9);
  for (std::size_t s = 0; s < grain.samples.size(); ++s) pictures[3].samples[s] += 0.1F * grain.samples[s];
  const TrackedDrawing run = track_drawing(pictures, drawn_options());
  EXPECT_EQ(run.models.size(), 6U);
  EXPECT_GT(run.reports[5].psnr, 35);
}

/// From black: there the one is as good as the other.
std::vector<image::Image> fading_in(const image::Image& picture) {
  std::vector<image::Image> pictures;
  for (const float light : {0.0F, 0.15F, 0.3F, 0.45F, 0.6F, 0.8F, 1.0F}) {
    pictures.push_back(picture);
    for (float& sample : pictures.back().samples) sample *= light;
  }
  return pictures;
}

TEST(DrawnFrames, ADrawingMayFadeIn) {
  const std::vector<image::Image> pictures = fading_in(drawing(34, 40));
  EXPECT_GT(track_drawing(pictures, drawn_options()).psnr, track_drawing(pictures, {}).psnr + 3);
}

TEST(DrawnFrames, FilmMayFadeIn) {
  image::Image film = test::random_8bit_picture(96, 72, 3, 4);
  for (int y = 0; y < film.height; ++y)
    for (int x = 0; x < film.width; ++x)
      for (int c = 0; c < 3; ++c)
        film.at(x, y, c) =
            0.1F * film.at(x, y, c) + 90 + 80 * std::sin(0.1F * float(x + c)) * std::cos(0.13F * float(y));
  const std::vector<image::Image> pictures = fading_in(film);
  EXPECT_GT(track_drawing(pictures, drawn_options()).psnr, track_drawing(pictures, {}).psnr - 0.3);
}

/// Shades, and noise in the lower half, which would make film of a first frame.
void blemish(image::Image& picture) {
  std::mt19937 random(5);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const float noise = y < picture.height / 2 ? 0 : float(random() % 13) - 6;
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) -= 0.8F * float(x) + noise;
    }
  }
}

TEST(DrawnFrames, CurvesFoundAheadChangeNothing) {
  std::vector<image::Image> pictures = drawn_clip(4);
  blemish(pictures[3]);
  ASSERT_FALSE(features::is_drawing(pictures[3]));
  ASSERT_TRUE(features::may_be_drawing(pictures[3]));
  const TrackedDrawing run = track_drawing(pictures, drawn_options());
  const TrackOptions options = drawn_options();
  Tracker tracker(vectorize::video_options(picture_options()), options);
  EXPECT_EQ(tracker.drawing(), Drawing::kNone);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    std::optional<Motion> motion;
    if (i > 0) motion = motion_between(pictures[i - 1], pictures[i]);
    // Those of another grid, which the group before may have been of, are left alone.
    const Drawing how = i == 2 ? Drawing::kPlain : Drawing::kFineGrid;
    MadeAhead ahead{.curves = find_drawn_curves(pictures[i], *options.drawn, how)};
    const document::FrameModel model =
        tracker.next(pictures[i], motion ? &*motion : nullptr, nullptr, std::move(ahead));
    EXPECT_EQ(tracker.drawing(), Drawing::kFineGrid);
    EXPECT_EQ(model.colour, run.models[i].colour) << i;
    EXPECT_EQ(model.displacement, run.models[i].displacement) << i;
  }
  EXPECT_EQ(find_drawn_curves(test::random_picture(64, 48, 3, 1), *options.drawn, Drawing::kPlain), nullptr);
}

TEST(DrawnFrames, HaveThePlainGridIfTheirFirstHas) {
  const std::vector<image::Image> pictures = drawn_clip(3);
  vectorize::Options picture = picture_options();
  picture.fine_grid = vectorize::FineGrid::kNone;
  TrackOptions options;
  options.drawn = std::make_shared<const vectorize::Options>(vectorize::drawn_video_options(picture));
  Tracker tracker(vectorize::video_options(picture), options);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    std::optional<Motion> motion;
    if (i > 0) motion = motion_between(pictures[i - 1], pictures[i]);
    tracker.next(pictures[i], motion ? &*motion : nullptr);
    EXPECT_EQ(tracker.drawing(), Drawing::kPlain);
  }
}

/// A ring at rest, and a box that moves.
image::Image ring_and_box(double box_x) {
  image::Image image = drawing(34, 40, box_x);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < 60; ++x) {
      const double share = std::clamp(17 - std::hypot(x + 0.5 - 34, y + 0.5 - 40), 0.0, 1.0);
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) += static_cast<float>(share) * (250.0F - 80.0F * float(c) - image.at(x, y, c));
    }
  }
  return image;
}

/// Outlines at rest were held once, while vertices on them came and went: circles became polygons.
TEST(DrawnFrames, OutlinesAtRestStayAsRoundAsTheyWere) {
  std::vector<image::Image> pictures;
  for (int i = 0; i < 30; ++i) pictures.push_back(ring_and_box(75 - 0.6 * i));
  TrackOptions options = drawn_options();
  options.drift = 100;
  const TrackedDrawing run = track_drawing(pictures, options);
  const auto farthest = [](const document::FrameModel& model) {
    const mesh::KnotMesh& mesh = model.space->mesh();
    std::vector<Vec2> points;
    for (const mesh::FeatureSegment& s : mesh.segments) {
      const Vec2 a = mesh.knots[s.knots.front()].position;
      const Vec2 b = mesh.knots[s.knots.back()].position;
      if (std::max(norm(a - Vec2{34, 40}), norm(b - Vec2{34, 40})) > 21) continue;
      for (int i = 0; i <= 8; ++i) points.push_back(a + (i / 8.0) * (b - a));
    }
    EXPECT_GT(points.size(), 100U);
    double worst = 0;
    for (const Vec2 p : fit::image_points(spline::Basis(model.space), model.displacement, points)) {
      const double radius = norm(p - Vec2{34, 40});
      worst = std::max(worst, std::abs(radius - (radius > 18.25 ? 20 : 16.5)));
    }
    return worst;
  };
  EXPECT_LT(farthest(run.models[1]), 0.1);
  EXPECT_LT(farthest(run.models.back()), farthest(run.models[1]) + 0.03);
}

/// Two vertices as good as at one place, which a grid of knots could not tell apart.
DrawnCurves unsound(const DrawnCurves& curves) {
  DrawnCurves result = curves;
  features::Chain& chain = result.found.faired.chains.front();
  features::ChainPoint& a = chain.points[chain.points.size() / 2];
  features::ChainPoint& b = chain.points[chain.points.size() / 2 + 1];
  a.corner = b.corner = true;
  b.move_to(a.on_curve() + Vec2{0.05, 0.05});
  return result;
}

TEST(DrawnFrames, WithoutASoundMeshAreCold) {
  const std::vector<image::Image> pictures = drawn_clip(4);
  const TrackOptions options = drawn_options();
  Tracker tracker(vectorize::video_options(picture_options()), options);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    std::optional<Motion> motion;
    if (i > 0) motion = motion_between(pictures[i - 1], pictures[i]);
    MadeAhead ahead{.curves = find_drawn_curves(pictures[i], *options.drawn, Drawing::kFineGrid)};
    if (i == 2) ahead.curves = std::make_shared<const DrawnCurves>(unsound(*ahead.curves));
    FrameReport report;
    const document::FrameModel model =
        tracker.next(pictures[i], motion ? &*motion : nullptr, &report, std::move(ahead));
    EXPECT_EQ(report.start, i == 0 ? Start::kFirst : i == 2 ? Start::kDrift : Start::kWarm) << i;
    EXPECT_EQ(model.keyframe, i % 2 == 0) << i;
    EXPECT_NE(tracker.drawing(), Drawing::kNone);
  }
}

TEST(ColdFrame, ADrawingIsDrawnIfThatIsBetterAndThereIsRoom) {
  const image::Image picture = drawing(34, 40);
  const auto cold = [&](std::size_t most) {
    const vectorize::Options film = vectorize::video_options(picture_options(most));
    vectorize::Options options = picture_options(most);
    options.feature_share = 1;
    const vectorize::Options drawn = vectorize::drawn_video_options(options);
    return make_cold_frame(picture, {film, &drawn}, 2);
  };
  EXPECT_TRUE(cold(1000)->frame.drawn);
  EXPECT_GT(cold(1000)->frame.drawn->share, 0.5);
  const std::size_t used = cold(1000)->frame.space->function_count();
  EXPECT_TRUE(cold(used * 2)->frame.drawn);
  // It uses up all of these, but is worth it by far; with fewer it would be above the bound, or is not.
  const std::size_t few = used;
  const auto limited = cold(few);
  EXPECT_TRUE(limited->frame.drawn);
  EXPECT_LE(limited->frame.space->function_count(), few);
  const auto as_film = make_cold_frame(picture, {vectorize::video_options(picture_options(few))}, 2);
  EXPECT_FALSE(as_film->frame.drawn);
  EXPECT_GT(psnr_as_drawn(limited->frame, picture), psnr_as_drawn(as_film->frame, picture) + 2.5);
  EXPECT_FALSE(cold(used * 9 / 10)->frame.drawn);
  EXPECT_FALSE(cold(used / 2)->frame.drawn);
}

/// Small squares in rows, more of them than a small bound is enough for.
image::Image many_squares() {
  image::Image image = image::make_image(160, 120, 3);
  std::fill(image.samples.begin(), image.samples.end(), 240.0F);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const int u = x % 16, v = y % 16;
      const bool inside = u > 3 && u < 12 && v > 3 && v < 12;
      const bool edge = u == 3 || v == 3 ? u >= 3 && u < 12 && v >= 3 && v < 12 : false;
      if (!inside && !edge) continue;
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = inside ? 30.0F : 110.0F;
    }
  }
  return image;
}

/// A frame of a group that is drawn on the fine grid.
FittedFrame fine_group() {
  FittedFrame frame;
  frame.drawn = FeatureLimits{.fine_grid = true};
  return frame;
}

TEST(ColdFrame, ADrawingWithoutRoomIsDenseIfThatIsWorthIt) {
  const vectorize::Options film = vectorize::video_options(picture_options(400));
  const vectorize::Options drawn = vectorize::drawn_video_options(picture_options(400));
  const vectorize::Options dense = vectorize::drawn_video_options(picture_options(6000));
  const image::Image squares = many_squares();
  EXPECT_FALSE(make_cold_frame(squares, {film, &drawn}, 2)->frame.drawn);
  const auto made = make_cold_frame(squares, {film, &drawn, &dense}, 2);
  ASSERT_TRUE(made->frame.drawn);
  EXPECT_TRUE(made->frame.dense);
  EXPECT_GT(made->frame.space->function_count(), 400U);
  const auto simple = make_cold_frame(drawing(34, 40), {film, &drawn, &dense}, 2);
  ASSERT_TRUE(simple->frame.drawn);
  EXPECT_FALSE(simple->frame.dense) << "it has room";
  // In a group that was simple, too.
  EXPECT_TRUE(make_drawn_frame(squares, {film, &drawn, &dense}, fine_group(), 2)->frame.dense);
  EXPECT_FALSE(make_drawn_frame(squares, {film, &drawn}, fine_group(), 2)->frame.dense);
  EXPECT_FALSE(make_drawn_frame(drawing(34, 40), {film, &drawn, &dense}, fine_group(), 2)->frame.dense);
}

/// More control points are for features; a few more are no better than film.
TEST(ColdFrame, ADrawingWithoutFeaturesIsFilmUnlessItMayHaveManyMore) {
  image::Image shades = image::make_image(160, 120, 3);
  for (int y = 0; y < shades.height; ++y) {
    for (int x = 0; x < shades.width; ++x) {
      for (int c = 0; c < 3; ++c)
        shades.at(x, y, c) = static_cast<float>(128 + 60 * std::sin(0.05 * x + c) * std::sin(0.04 * y));
    }
  }
  ASSERT_TRUE(features::is_drawing(shades));
  const vectorize::Options film = vectorize::video_options(picture_options(260));
  const vectorize::Options drawn = vectorize::drawn_video_options(picture_options(260));
  const vectorize::Options more = vectorize::drawn_video_options(picture_options(500));
  const auto made = make_cold_frame(shades, {film, &drawn, &more}, 2);
  EXPECT_FALSE(made->frame.drawn);
  EXPECT_TRUE(made->frame.space->mesh().segments.empty());
  EXPECT_EQ(made->frame.colours.control, make_cold_frame(shades, {film}, 2)->frame.colours.control);
  // With features it is drawn all the same.
  EXPECT_TRUE(make_cold_frame(drawing(34, 40), {film, &drawn, &more}, 2)->frame.drawn);
}

/// There is no room for all of its features even so.
TEST(ColdFrame, ADrawingWithoutRoomIsDenseAsFilmIfItCannotBeSeenElse) {
  const vectorize::Options film = vectorize::video_options(picture_options(400));
  const vectorize::Options drawn = vectorize::drawn_video_options(picture_options(400));
  const vectorize::Options dense = vectorize::video_options(picture_options(1500));
  const image::Image squares = many_squares();
  const auto sparse = make_cold_frame(squares, {film, &drawn}, 2);
  ASSERT_LT(psnr_as_drawn(sparse->frame, squares), 35);
  const auto made = make_cold_frame(squares, {film, &drawn, nullptr, &dense}, 2);
  EXPECT_FALSE(made->frame.drawn);
  EXPECT_TRUE(made->frame.dense);
  EXPECT_GT(made->frame.space->function_count(), 400U);
  EXPECT_LE(made->frame.space->function_count(), 1500U);
  EXPECT_GT(psnr_as_drawn(made->frame, squares), psnr_as_drawn(sparse->frame, squares) + 4);
  const vectorize::Options hardly_more = vectorize::video_options(picture_options(450));
  EXPECT_FALSE(make_cold_frame(squares, {film, &drawn, nullptr, &hardly_more}, 2)->frame.dense)
      << "no better";
  // Faint squares can be seen as they are.
  image::Image faint = squares;
  for (float& sample : faint.samples) sample = 220 + sample / 16;
  const auto seen = make_cold_frame(faint, {film, &drawn, nullptr, &dense}, 2);
  EXPECT_GT(psnr_as_drawn(seen->frame, faint), 35);
  EXPECT_FALSE(seen->frame.dense);
}

/// With shades between them, which ask for control points, too.
image::Image shaded_squares() {
  image::Image squares = many_squares();
  for (int y = 0; y < squares.height; ++y) {
    for (int x = 0; x < squares.width; ++x) {
      const double shade = 15 + 15 * std::sin(0.25 * x) * std::sin(0.25 * y);
      for (int c = 0; c < 3; ++c) squares.at(x, y, c) -= static_cast<float>(shade);
    }
  }
  return squares;
}

/// Frames behind it will often have no room, but they can be seen.
TEST(ColdFrame, ADrawingIsCrampedIfItCannotBeSeenElse) {
  const vectorize::Options film = vectorize::video_options(picture_options(400));
  const vectorize::Options drawn = vectorize::drawn_video_options(picture_options(400));
  const auto cold = [&](const image::Image& picture, std::size_t most) {
    const vectorize::Options cramped = vectorize::drawn_video_options(picture_options(most));
    return make_cold_frame(picture, {film, &drawn, nullptr, nullptr, &cramped}, 2);
  };
  const image::Image squares = shaded_squares();
  const auto cramped = cold(squares, 6000);
  ASSERT_TRUE(cramped->frame.drawn);
  EXPECT_TRUE(cramped->frame.dense);
  EXPECT_TRUE(cramped->frame.cramped);
  EXPECT_GT(cramped->frame.space->function_count(), 5800U);
  EXPECT_GE(psnr_as_drawn(cramped->frame, squares), kLegible);
  EXPECT_FALSE(cold(squares, 3000)->frame.drawn) << "not even its features have room";
  image::Image faint = squares;
  for (float& sample : faint.samples) sample = 220 + sample / 16;
  EXPECT_FALSE(cold(faint, 6000)->frame.drawn) << "it can be seen as film";
  // As dense film it is cheaper, if it can be seen so.
  image::Image medium = squares;
  for (float& sample : medium.samples) sample = 200 + sample / 6;
  const auto medium_cold = [&](std::size_t most) {
    const vectorize::Options dense_film = vectorize::video_options(picture_options(most));
    const vectorize::Options larger = vectorize::drawn_video_options(picture_options(6000));
    return make_cold_frame(medium, {film, &drawn, nullptr, &dense_film, &larger}, 2)->frame;
  };
  EXPECT_TRUE(medium_cold(420).cramped);
  const FittedFrame seen = medium_cold(4000);
  EXPECT_GE(psnr_as_drawn(seen, medium), kLegible);
  EXPECT_FALSE(seen.drawn);
  EXPECT_TRUE(seen.dense);
}

/// In one group, while the pictures become darker by a level each, and have more than `least` control points.
void expect_to_stay_within(TrackOptions options, std::vector<image::Image> pictures, std::size_t least,
                           std::size_t most) {
  options.drift = 100;
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    for (float& sample : pictures[i].samples) sample -= float(i);
  }
  const TrackedDrawing run = track_drawing(pictures, options, 400);
  for (const FrameReport& report : run.reports) {
    EXPECT_EQ(report.start == Start::kWarm, &report != &run.reports.front());
    EXPECT_GT(report.control_points, least);
    EXPECT_LE(report.control_points, most);
  }
}

TEST(DrawnFrames, ThatAreCrampedStaySo) {
  TrackOptions options = drawn_options(400);
  const auto bound = [](std::size_t most) {
    return std::make_shared<const vectorize::Options>(vectorize::drawn_video_options(picture_options(most)));
  };
  options.dense = bound(3000);
  options.cramped = bound(6000);
  expect_to_stay_within(options, std::vector(3, shaded_squares()), 5000, 6000);
}

/// It can be seen at first, and then no more.
TEST(DrawnFrames, FilmOfADrawingBecomesDenseInItsMidst) {
  TrackOptions options = drawn_options(400);
  std::vector<image::Image> pictures;
  for (const float faintness : {16.0F, 12.0F, 8.0F, 5.0F, 3.0F}) {
    pictures.push_back(many_squares());
    for (float& sample : pictures.back().samples) sample = 150 + sample / faintness;
  }
  const std::vector<FrameReport> film = track_drawing(pictures, options, 400).reports;
  for (const FrameReport& report : film) EXPECT_LE(report.control_points, 400U);
  options.dense_film =
      std::make_shared<const vectorize::Options>(vectorize::video_options(picture_options(1500)));
  const std::vector<FrameReport> dense = track_drawing(pictures, options, 400).reports;
  EXPECT_LE(dense.front().control_points, 400U) << "it can be seen";
  EXPECT_GT(dense.back().control_points, 800U);
  EXPECT_GT(dense.back().psnr, film.back().psnr + 3);
}

/// Film with grain, and letters over it: rings, antialiased by 4 x 4 samples per pixel.
image::Image film_with_captions(int rows_of_rings, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> grain(0, 3);
  image::Image film = image::make_image(160, 128, 1);
  for (int y = 0; y < film.height; ++y) {
    for (int x = 0; x < film.width; ++x) {
      int ink = 0;
      for (int s = 0; s < 16 && y >= film.height - 16 * rows_of_rings; ++s) {
        const double r = std::hypot(x % 16 + s % 4 / 4.0 - 7.6, y % 16 + s / 4 / 4.0 - 7.6);
        ink += r > 3.5 && r < 6 ? 1 : 0;
      }
      const float ground = 80 + 30 * float(std::sin(x / 25.0) * std::cos(y / 21.0)) + grain(random);
      film.at(x, y, 0) = ground + float(ink) / 16 * (255 - ground);
    }
  }
  return film;
}

TEST(Film, HasRoomForCaptionsThatCome) {
  std::vector<image::Image> pictures;
  for (unsigned i = 0; i < 6; ++i) pictures.push_back(film_with_captions(i < 2 ? 0 : 2, i));
  TrackOptions options = drawn_options(300);
  const std::vector<FrameReport> plain = track_drawing(pictures, options, 300).reports;
  for (const FrameReport& report : plain) EXPECT_LE(report.control_points, 300U);
  options.dense_film =
      std::make_shared<const vectorize::Options>(vectorize::video_options(picture_options(900)));
  const std::vector<FrameReport> roomy = track_drawing(pictures, options, 300).reports;
  for (std::size_t i : {0U, 1U}) EXPECT_LE(roomy[i].control_points, 300U) << "nothing came so far";
  EXPECT_GT(roomy.back().control_points, 500U);
  EXPECT_LE(roomy.back().control_points, 900U);
  EXPECT_GT(roomy.back().psnr, plain.back().psnr + 3);
}

TEST(Film, HasTheUsualRoomWhereCaptionsAreGone) {
  TrackOptions options = drawn_options(300);
  options.scene_threshold = 1;
  options.drift = 100;
  options.dense_film =
      std::make_shared<const vectorize::Options>(vectorize::video_options(picture_options(900)));
  Tracker tracker(vectorize::video_options(picture_options(300)), options);
  const image::Image captioned = film_with_captions(2, 1), next = film_with_captions(0, 2);
  FrameReport report;
  tracker.next(captioned, nullptr, &report);
  EXPECT_GT(report.control_points, 500U);
  const Motion motion = motion_between(captioned, next);
  tracker.next(next, &motion, &report);
  ASSERT_EQ(report.start, Start::kWarm);
  EXPECT_GT(report.control_points, 300U) << "they may come back";
  tracker.next(film_with_captions(0, 3), nullptr, &report);  // another group
  EXPECT_LE(report.control_points, 300U);
  for (unsigned i = 3; i < 9; ++i) {
    const image::Image now = film_with_captions(0, i + 1);
    const Motion on = motion_between(film_with_captions(0, i), now);
    tracker.next(now, &on, &report);
    EXPECT_LE(report.control_points, 300U);
  }
}

TEST(DrawnFrames, ThatAreDenseAsFilmStayDense) {
  TrackOptions options = drawn_options(400);
  options.dense_film =
      std::make_shared<const vectorize::Options>(vectorize::video_options(picture_options(1500)));
  expect_to_stay_within(options, std::vector(4, many_squares()), 1000, 1500);
}

/// A bound that is a good part of the pixels is there to be filled.
TEST(ColdFrame, ADrawingMayFillAGenerousBound) {
  const image::Image squares = many_squares();
  const auto cold = [&](double share) {
    const auto most = static_cast<std::size_t>(share * double(squares.pixel_count()));
    const vectorize::Options film = vectorize::video_options(picture_options(most));
    const vectorize::Options drawn = vectorize::drawn_video_options(picture_options(most));
    return make_cold_frame(squares, {film, &drawn}, 2);
  };
  const double needed = double(cold(0.5)->frame.space->function_count()) / double(squares.pixel_count());
  ASSERT_GT(needed, 0.1);
  EXPECT_TRUE(cold(0.95 * needed)->frame.drawn);
  EXPECT_FALSE(cold(0.04)->frame.drawn);
}

TEST(ColdFrame, WhatWasGoodEnoughIsDenseIfItHasNoRoom) {
  vectorize::Options options = picture_options(400);
  options.mec = 100;  // anything is
  const vectorize::Options film = vectorize::video_options(options);
  const vectorize::Options drawn = vectorize::drawn_video_options(options);
  options.max_control_points = 6000;
  const vectorize::Options dense = vectorize::drawn_video_options(options);
  EXPECT_TRUE(make_drawn_frame(many_squares(), {film, &drawn, &dense}, fine_group(), 2)->frame.dense);
}

/// A drawing that is made as film since it has no room tells what a still like it has.
TEST(DrawnFrames, TellWhatTheyLack) {
  const auto first = [](const image::Image& picture, std::size_t most, bool drawn) {
    return track_drawing({picture}, drawn ? drawn_options(most) : TrackOptions(), most).reports.front();
  };
  EXPECT_EQ(first(many_squares(), 400, true).wanted_control_points,
            vectorize::default_control_points(many_squares()));
  EXPECT_EQ(first(many_squares(), 400, false).wanted_control_points, 0U) << "nobody wants it drawn";
  EXPECT_EQ(first(drawing(34, 40), 1000, true).wanted_control_points, 0U) << "it is drawn";
  EXPECT_EQ(first(test::random_picture(64, 48, 3, 1), 400, true).wanted_control_points, 0U) << "a film";
}

/// As codecs leave them: with noise around an edge, which costs more on the fine grid.
image::Image noisy_drawing() {
  image::Image image = drawing(34, 60, 40);
  std::mt19937 random(7);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const bool at_edge = std::abs(std::hypot(x - 34, y - 60) - 20) < 5;
      const float noise = float(random() % 25) - 12;
      for (int c = 0; c < 3 && at_edge; ++c) image.at(x, y, c) += noise;
    }
  }
  return image;
}

TEST(ColdFrame, ThePlainGridMayHaveRoomWhereTheFineOneHasNone) {
  const image::Image picture = noisy_drawing();
  std::string ways;  // by growing bounds, each once
  for (double most = 400; most < 1000; most *= 1.06) {
    const vectorize::Options film = vectorize::video_options(picture_options(std::size_t(most)));
    const vectorize::Options drawn = vectorize::drawn_video_options(picture_options(std::size_t(most)));
    const auto made = make_cold_frame(picture, {film, &drawn}, 2);
    const char way = !made->frame.drawn ? 'f' : made->frame.drawn->fine_grid ? 'F' : 'P';
    if (ways.empty() || ways.back() != way) ways += way;
  }
  EXPECT_EQ(ways.front(), 'f') << ways;
  EXPECT_NE(ways.find('P'), std::string::npos) << ways;
  EXPECT_EQ(ways.back(), 'F') << ways;
}

TEST(DrawnFrames, ThatAreDenseGrowByAFifthAtMost) {
  TrackOptions options = drawn_options(400);
  options.dense =
      std::make_shared<const vectorize::Options>(vectorize::drawn_video_options(picture_options(6000)));
  options.drift = 100;
  options.growth = 0.5;
  std::vector<image::Image> pictures(6, many_squares());
  // Noise that nothing can hold makes it grow.
  std::mt19937 random(7);
  for (std::size_t i = 1; i < pictures.size(); ++i) {
    for (float& sample : pictures[i].samples) sample += float(random() % 41) - 20;
  }
  const TrackedDrawing run = track_drawing(pictures, options, 400);
  const std::size_t first = run.reports.front().control_points;
  ASSERT_GT(first, 400U);
  std::size_t most = 0;
  for (const FrameReport& report : run.reports) {
    EXPECT_EQ(report.start == Start::kWarm, &report != &run.reports.front());
    most = std::max(most, report.control_points);
  }
  EXPECT_LE(double(most), 1.25 * double(first));
}

/// Rows of squares come one by one.
TEST(DrawnFrames, ThatAreDenseGrowWithTheirFeatures) {
  TrackOptions options = drawn_options(400);
  options.dense =
      std::make_shared<const vectorize::Options>(vectorize::drawn_video_options(picture_options(8000)));
  options.drift = 100;
  std::vector<image::Image> pictures(14, many_squares());
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const int rows = i < 4 ? 64 : 96;
    for (int y = rows; y < 120; ++y) std::ranges::fill(pictures[i].row(y), 240.0F);
    for (int y = 106; y < 112; ++y) {  // a dot moves
      for (int x = 0; x < 18; ++x) pictures[i].row(y)[std::size_t(3 * (10 + 2 * int(i)) + x)] = 30;
    }
    // Something for knots beside the features: soft spots, which are wherever there are squares.
    for (int y = 0; y < rows; ++y) {
      for (int x = 0; x < 160; ++x) {
        const double r = std::hypot(x % 16 - 15, y % 16 - 15);
        for (int c = 0; c < 3; ++c) pictures[i].at(x, y, c) -= float(40 * std::exp(-r * r / 4));
      }
    }
  }
  const TrackedDrawing run = track_drawing(pictures, options, 400);
  const auto free_knots = [&](std::size_t i) {
    const auto& knots = run.models[i].space->mesh().knots;
    return std::ranges::count_if(knots, [](const auto& k) { return k.kind == mesh::KnotKind::kFree; });
  };
  EXPECT_EQ(run.reports.back().start, Start::kWarm);
  EXPECT_GT(free_knots(13), 2 * free_knots(3));
  EXPECT_GT(run.reports[13].psnr, run.reports[3].psnr - 2);
}

/// A row of squares more in every frame.
std::vector<image::Image> squares_that_come(int first, int frames) {
  std::vector<image::Image> pictures(std::size_t(frames), many_squares());
  for (int i = 0; i < frames; ++i) {
    image::Image& picture = pictures[std::size_t(i)];
    for (int y = 16 * (first + i); y < picture.height; ++y) std::ranges::fill(picture.row(y), 240.0F);
  }
  return pictures;
}

TEST(DrawnFrames, KeepTheBoundWhereFeaturesAloneAreTooMany) {
  constexpr std::size_t kMost = 1800;
  TrackOptions options = drawn_options(kMost);
  options.drift = 100;
  const TrackedDrawing run = track_drawing(squares_that_come(2, 5), options, kMost);
  EXPECT_FALSE(run.models.front().space->mesh().segments.empty());
  for (const FrameReport& report : run.reports) EXPECT_LE(report.control_points, kMost);
}

/// @param mec in levels: what misses it asks for knots.
void expect_no_memory(double mec) {
  SCOPED_TRACE(mec);
  const std::vector<image::Image> pictures = drawn_clip(8);
  vectorize::Options picture = picture_options(1500);
  picture.mec = mec;
  TrackOptions options;
  options.drawn = std::make_shared<const vectorize::Options>(vectorize::drawn_video_options(picture));
  const vectorize::Options film = vectorize::video_options(picture);
  Tracker used(film, options), fresh(film, options);
  for (std::size_t i = 0; i < 3; ++i) {
    std::optional<Motion> motion;
    if (i > 0) motion = motion_between(pictures[i - 1], pictures[i]);
    used.next(pictures[i], motion ? &*motion : nullptr);
  }
  for (std::size_t i = 4; i < pictures.size(); ++i) {
    std::optional<Motion> motion;
    if (i > 4) motion = motion_between(pictures[i - 1], pictures[i]);
    const document::FrameModel a = used.next(pictures[i], motion ? &*motion : nullptr);
    const document::FrameModel b = fresh.next(pictures[i], motion ? &*motion : nullptr);
    EXPECT_NE(fresh.drawing(), Drawing::kNone);
    EXPECT_EQ(a.colour, b.colour) << i;
    EXPECT_EQ(a.displacement, b.displacement) << i;
  }
}

TEST(DrawnFrames, DoNotKnowTheGroupBefore) {
  constexpr std::array kMecs{0.2, 0.05, 0.1, 0.4};
  for (int i = 0; i < testing::rounds(int(kMecs.size())); ++i) expect_no_memory(kMecs.at(std::size_t(i)));
}

/// A disk moves on the left. On the right there are shades, which knots would follow, and nothing moves.
image::Image drawing_half_at_rest(int frame) {
  image::Image image = image::make_image(240, 90, 3);
  const image::Image left = drawing(30, 36 + 1.3 * frame);
  const image::Image right = drawing(30, 40);
  for (int y = 0; y < 90; ++y) {
    for (int x = 0; x < 240; ++x) {
      const double r = std::hypot(x - 216, y - 14);
      for (int c = 0; c < 3; ++c) {
        image.at(x, y, c) = x < 120 ? left.at(x, y, c) : right.at(x - 120, y, c);
        image.at(x, y, c) -= float(90 * std::exp(-r * r / 60));
      }
    }
  }
  return image;
}

TEST(DrawnFrames, KnotsAtRestStay) {
  std::vector<image::Image> pictures;
  for (int i = 0; i < 18; ++i) pictures.push_back(drawing_half_at_rest(i % 9));
  TrackOptions options = drawn_options(1500);
  options.drift = 100;
  const TrackedDrawing run = track_drawing(pictures, options, 1500);
  const auto at_rest = [&](std::size_t i) {
    std::map<mesh::KnotId, Vec2> places;
    for (const mesh::Knot& k : run.models[i].space->mesh().knots) {
      if (k.kind == mesh::KnotKind::kFree && k.position.x > 180) places[k.id] = k.position;
    }
    return places;
  };
  const auto before = at_rest(8);
  EXPECT_GT(before.size(), 3U);
  std::size_t moved = 0;
  for (const auto& [id, place] : at_rest(17)) moved += before.contains(id) && before.at(id) != place ? 1 : 0;
  EXPECT_EQ(moved, 0U);
}

TEST(DrawnFrames, KeepEdgesShort) {
  constexpr double kLongest = 20;
  TrackOptions options = drawn_options(1500);
  vectorize::Options drawn = *options.drawn;
  drawn.longest_edge = kLongest;
  options.drawn = std::make_shared<const vectorize::Options>(drawn);
  const TrackedDrawing run = track_drawing(drawn_clip(16), options, 1500);
  for (std::size_t i = 1; i < run.models.size(); ++i) {  // the first has optimised its mesh since
    const mesh::KnotMesh& mesh = run.models[i].space->mesh();
    double longest = 0;
    for (const mesh::Face& face : mesh.faces) {
      for (std::size_t c = 0; c < 3; ++c)
        longest =
            std::max(longest, norm(mesh.knots[face[(c + 1) % 3]].position - mesh.knots[face[c]].position));
    }
    EXPECT_LT(longest, 1.2 * kLongest) << i;
  }
}

TEST(ColdFrame, ADrawingWithSoftEdgesIsDrawnOnlyIfThatIsBetter) {
  const image::Image crisp = drawing(34, 40);
  image::Image picture = crisp;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 1; x + 1 < picture.width; ++x) {
      for (int c = 0; c < 3; ++c)
        picture.at(x, y, c) = static_cast<float>(test::softened(crisp, x, y, c, 0.15));
    }
  }
  const vectorize::Options film = vectorize::video_options(picture_options());
  EXPECT_FALSE(make_cold_frame(picture, {film, &film}, 2)->frame.drawn) << "it is the same";
  const std::size_t film_alone = make_cold_frame(picture, {film}, 2)->frame.space->function_count();
  EXPECT_EQ(make_cold_frame(picture, {film, &film}, 2)->frame.space->function_count(), film_alone);
}

TEST(ColdFrame, WhatIsWatchedIsWhatIsKept) {
  const image::Image picture = drawing(34, 40);
  const vectorize::Options film = vectorize::video_options(picture_options());
  const vectorize::Options drawn = vectorize::drawn_video_options(picture_options());
  std::vector<std::string> stages;
  const auto watched = make_cold_frame(picture, {film, &drawn}, 2,
                                       [&](const vectorize::Progress& p) { stages.push_back(p.stage); });
  EXPECT_EQ(std::count(stages.begin(), stages.end(), "features"), 1);
  EXPECT_EQ(watched->frame.colours.control,
            make_cold_frame(picture, {film, &drawn}, 2)->frame.colours.control);
}

}  // namespace
}  // namespace knotreel::track
