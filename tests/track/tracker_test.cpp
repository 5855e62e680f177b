// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <sstream>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/document/stored_mesh.h"
#include "knotreel/document/writer.h"
#include "knotreel/fit/pixel_places.h"
#include "knotreel/raster/render.h"
#include "knotreel/spline/surface.h"
#include "knotreel/vectorize/vectorize.h"
#include "support/pictures.h"

namespace knotreel::track {
namespace {

/// A shaded disk with a sharp edge on a soft background, its centre at (x, y).
image::Image scene(double x, double y) {
  image::Image image = image::make_image(96, 72, 3);
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      const double dx = i + 0.5 - x;
      const double dy = j + 0.5 - y;
      const double inside = std::clamp(18 - std::hypot(dx, dy) + 0.5, 0.0, 1.0);
      for (int c = 0; c < 3; ++c) {
        const double back = 60 + 40 * std::sin(0.07 * i + c) + 30 * std::cos(0.09 * j);
        const double disk = 200 - 2.5 * dx - 2 * dy + 10 * c;
        image.at(i, j, c) = static_cast<float>(std::clamp(back + inside * (disk - back), 0.0, 255.0));
      }
    }
  }
  return image;
}

/// Those of videos, but features may have as much as they need: the scenes are small.
vectorize::Options cold_options() {
  vectorize::Options options = vectorize::video_options({});
  options.feature_share = 0.6;
  return options;
}

struct Tracked {
  std::vector<document::FrameModel> models;
  std::vector<FrameReport> reports;
};

Tracked track(const std::vector<image::Image>& pictures, const TrackOptions& options, double mec = 2) {
  vectorize::Options cold = cold_options();
  cold.max_control_points = 400;
  cold.mec = mec;
  Tracker tracker(cold, options);
  Tracked run;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    FrameReport report;
    if (i == 0) {
      run.models.push_back(tracker.next(pictures[i], nullptr, &report));
    } else {
      const Motion m = motion_between(pictures[i - 1], pictures[i]);
      run.models.push_back(tracker.next(pictures[i], &m, &report));
    }
    run.reports.push_back(report);
  }
  return run;
}

std::vector<image::Image> moving(int frames) {
  std::vector<image::Image> pictures;
  for (int i = 0; i < frames; ++i) pictures.push_back(scene(40 + 1.3 * i, 36 + 0.7 * i));
  return pictures;
}

TEST(Tracker, FramesAreWarmAndGood) {
  const Tracked run = track(moving(6), {});
  TrackOptions anew;
  anew.warm_start = false;
  const Tracked cold = track(moving(6), anew);
  EXPECT_EQ(run.reports[0].start, Start::kFirst);
  double warm_error = 0;
  double cold_error = 0;
  for (std::size_t i = 1; i < run.reports.size(); ++i) {
    EXPECT_EQ(run.reports[i].start, Start::kWarm) << i;
    EXPECT_FALSE(run.models[i].keyframe);
    EXPECT_LT(run.reports[i].mec, 1.5) << i;  // 1.2 of which comes from colours in steps of 3 levels
    warm_error += run.reports[i].mec;
    cold_error += cold.reports[i].mec;
    EXPECT_GT(run.reports[i].survival, 0.8) << i;
    EXPECT_NEAR(double(run.reports[i].control_points), double(run.reports[0].control_points),
                0.15 * double(run.reports[0].control_points));
  }
  EXPECT_LT(warm_error, 1.2 * cold_error);
}

/// In the first frame, and in the second, where softness is looked for again.
TEST(Tracker, EdgesAreAsSoftAsInThePictures) {
  std::vector<image::Image> sharp = moving(3);
  std::vector<image::Image> soft;
  for (const image::Image& picture : sharp) soft.push_back(test::softened(picture, 0.125));
  const Tracked sharp_run = track(sharp, {});
  const Tracked soft_run = track(soft, {});
  for (std::size_t i = 0; i < sharp.size(); ++i) {
    ASSERT_FALSE(soft_run.models[i].space->mesh().segments.empty());
    EXPECT_LT(sharp_run.models[i].edge_softness, 0.05) << i;
    EXPECT_NEAR(soft_run.models[i].edge_softness, 0.125, 0.05) << i;
  }
}

/// What is drawn is what was fitted, and the graph has no space and no basis to make anew.
TEST(Tracker, WarmFramesAreStoredWithTheSpaceAndGeometryThatTheyHave) {
  const std::vector<image::Image> pictures = moving(4);
  vectorize::Options cold = cold_options();
  cold.max_control_points = 400;
  Tracker tracker(cold, {});
  std::ostringstream out;
  document::SequenceInfo info;
  info.width = pictures[0].width;
  info.height = pictures[0].height;
  document::Writer writer(out, info);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    std::optional<Motion> motion;
    if (i > 0) motion = motion_between(pictures[i - 1], pictures[i]);
    document::FrameModel model = tracker.next(pictures[i], motion ? &*motion : nullptr);
    model.frame = i;
    model.pts = static_cast<std::int64_t>(i);
    EXPECT_EQ(&tracker.surface()->basis->space(), model.space.get());
    const document::FrameModel stored = writer.append(model);
    if (i == 0) continue;
    EXPECT_EQ(stored.space, model.space) << i;
    EXPECT_EQ(stored.displacement, model.displacement) << i;
    EXPECT_EQ(stored.colour, model.colour) << i;
    EXPECT_TRUE(std::ranges::any_of(model.displacement, [](Vec2 d) { return d != Vec2{}; })) << i;
    // What was fitted is what is drawn.
    const auto drawn = [&](std::shared_ptr<const spline::PixelSurface> known) {
      std::vector<float> rows(pictures[0].samples.size());
      raster::Renderer(stored, {}, tracker.surface()->basis, std::move(known)).rows(0, info.height, rows);
      return rows;
    };
    EXPECT_EQ(drawn(tracker.surface()), drawn(nullptr)) << i;
  }
}

/// Waves that have gone x pixels to the right.
image::Image waves(double x) {
  image::Image image = image::make_image(96, 72, 1);
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      const double u = i - x;
      image.at(i, j, 0) = static_cast<float>(128 + 50 * std::sin(0.31 * u + 0.1 * j) * std::cos(0.23 * j) +
                                             40 * std::sin(0.17 * u - 0.2 * j));
    }
  }
  return image;
}

TEST(Tracker, KnotsFollowMotionSlowerThanTheirGrid) {
  TrackOptions options;
  options.knot_bits = 0;
  options.settle = false;
  constexpr int kFrames = 14;
  constexpr double kSpeed = 0.4;
  std::vector<image::Image> pictures;
  for (int i = 0; i < kFrames; ++i) pictures.push_back(waves(kSpeed * i));
  const Tracked run = track(pictures, options);
  std::map<mesh::KnotId, Vec2> first;
  for (const mesh::Knot& k : run.models.front().space->mesh().knots) {
    if (k.kind == mesh::KnotKind::kFree) first[k.id] = k.position;
  }
  double way = 0;
  int count = 0;
  for (const mesh::Knot& k : run.models.back().space->mesh().knots) {
    if (!first.contains(k.id)) continue;
    way += k.position.x - first[k.id].x;
    ++count;
  }
  ASSERT_GT(count, 20);
  EXPECT_NEAR(way / count, kSpeed * (kFrames - 1), 0.8);  // a fifth of them is in the dead zone
}

TEST(Tracker, ARepeatedPictureKeepsItsModel) {
  const std::vector<image::Image> pictures = moving(4);
  vectorize::Options cold = cold_options();
  cold.max_control_points = 400;
  Tracker plain(cold, {});
  Tracker repeating(cold, {});
  const Motion repeated = motion_between(pictures[0], pictures[0]);
  EXPECT_TRUE(repeated.repeated);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const Motion m = i > 0 ? motion_between(pictures[i - 1], pictures[i]) : Motion();
    const Motion* motion = i > 0 ? &m : nullptr;
    FrameReport report;
    const document::FrameModel expected = plain.next(pictures[i], motion);
    const document::FrameModel model = repeating.next(pictures[i], motion, &report);
    EXPECT_EQ(model.colour, expected.colour) << "what was repeated before has left something behind, " << i;
    FrameReport again;
    const document::FrameModel same = repeating.next(pictures[i], &repeated, &again);
    EXPECT_EQ(same.space, model.space);
    EXPECT_EQ(same.colour, model.colour);
    EXPECT_EQ(same.displacement, model.displacement);
    EXPECT_FALSE(same.keyframe);
    EXPECT_EQ(again.start, Start::kWarm);
    EXPECT_EQ(again.psnr, report.psnr);
    EXPECT_EQ(again.survival, 1);
    EXPECT_EQ(again.knots, report.knots);
  }
}

TEST(Tracker, ARepeatedKeyframeIsNotMadeAgain) {
  const image::Image picture = moving(1).front();
  vectorize::Options cold = cold_options();
  cold.max_control_points = 100;
  cold.mec = 0.01;  // missed
  TrackOptions options;
  options.look_interval = 1;
  Tracker tracker(cold, options);
  const Motion repeated = motion_between(picture, picture);
  const document::FrameModel first = tracker.next(picture, nullptr);
  for (int i = 0; i < 3; ++i) {
    FrameReport report;
    const document::FrameModel same = tracker.next(picture, &repeated, &report);
    EXPECT_EQ(same.space, first.space);
    EXPECT_EQ(report.start, Start::kWarm);
  }
}

/// Share of the colours of control points that change from frame to frame while nothing but noise does.
double share_of_changed_colours(TrackOptions options) {
  std::vector<image::Image> pictures(8, scene(40, 36));
  std::mt19937 random(20261123);
  std::normal_distribution<float> noise(0, 0.1F);
  for (image::Image& picture : pictures) {
    for (float& s : picture.samples) s += noise(random);
  }
  const Tracked run = track(pictures, options);
  std::size_t changed = 0;
  std::size_t all = 0;
  for (std::size_t i = 3; i < pictures.size(); ++i) {  // the first settle what a keyframe has other steps of
    const document::FrameModel& before = run.models[i - 1];
    const document::FrameModel& now = run.models[i];
    if (before.colour.size() != now.colour.size()) continue;
    for (std::size_t c = 0; c < now.colour.size(); ++c) changed += before.colour[c] != now.colour[c];
    all += now.colour.size();
  }
  EXPECT_GT(all, 0u);
  return static_cast<double>(changed) / static_cast<double>(all);
}

/// What rounding leaves is a part of what was missed, half of which is taken off the next picture; and
/// control points stop short of where they would be best.
/// A small disk that moves on the left, and on the right a disk with a sharp edge at rest.
image::Image half_at_rest(int frame) {
  image::Image image = image::make_image(240, 96, 3);
  const image::Image still = scene(44, 36);
  for (int j = 0; j < image.height; ++j) {
    for (int i = 0; i < image.width; ++i) {
      for (int c = 0; c < 3; ++c) {
        if (i >= 144) {
          image.at(i, j, c) = still.at(i - 144, std::min(j, 71), c);
          continue;
        }
        const double inside =
            std::clamp(12.5 - std::hypot(i - 20 - 1.5 * std::abs((frame + 40) % 80 - 40), j - 50), 0.0, 1.0);
        image.at(i, j, c) = static_cast<float>(120 + 30 * std::sin(0.05 * i + 0.06 * j) + 80 * inside);
      }
    }
  }
  return image;
}

std::vector<image::Image> halves_at_rest(int frames) {
  std::vector<image::Image> pictures;
  for (int i = 0; i < frames; ++i) pictures.push_back(half_at_rest(i));
  return pictures;
}

/// Knots, and what is drawn where no function reaches what moves.
TEST(Tracker, WhatIsAtRestStaysAsItIs) {
  const std::vector<image::Image> pictures = halves_at_rest(90);
  vectorize::Options cold = cold_options();
  cold.max_control_points = 700;
  cold.mec = 1;
  cold.block_error = 0;  // else knots that get lost on the left come and go at the edge on the right
  TrackOptions options;
  options.restart_gain = 100;                          // a new group would have other knots
  options.swap.share = options.urgent_swap.share = 0;  // idle ones of the edge on the right would come and go
  Tracker tracker(cold, options);
  std::map<std::uint32_t, Vec2> knots;
  std::shared_ptr<const spline::PixelSurface> drawn;
  std::array<double, 2> softness{};  // of the two frames before
  bool is_bent = false;              // in the frame before, for new features: all curves are then
  int compared = 0;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    std::optional<Motion> motion;
    if (i > 0) motion = motion_between(pictures[i - 1], pictures[i]);
    FrameReport report;
    const document::FrameModel model = tracker.next(pictures[i], motion ? &*motion : nullptr, &report);
    ASSERT_EQ(report.start, i == 0 ? Start::kFirst : Start::kWarm) << i;
    std::map<std::uint32_t, Vec2> now;
    for (const mesh::Knot& k : model.space->mesh().knots) {
      if (k.position.x > 176) now[static_cast<std::uint32_t>(k.id)] = k.position;
    }
    if (i >= 64) {  // until then some knots settle; thin faces may ask for a finer grid of all later
      EXPECT_TRUE(now == knots) << i;
      std::size_t changed = 0;
      for (int y = 0; y < 96; ++y) {
        for (std::size_t n = std::size_t(y) * 720 + 3 * 220; n < std::size_t(y + 1) * 720; ++n)
          changed += tracker.surface()->colours[n] != drawn->colours[n] ? 1 : 0;
      }
      const bool was_bent = std::exchange(is_bent, report.changes.features_born > 0);
      // Else edges are fitted anew everywhere. Colours at bent curves settle with the second fit.
      if (softness[0] == softness[1] && !is_bent && !was_bent) {
        ++compared;
        EXPECT_EQ(changed, 0u) << i;
      }
    }
    softness = {softness[1], model.edge_softness};
    knots = now;
    drawn = tracker.surface();
  }
  EXPECT_GE(compared, 20);
}

/// What is kept from the frame before is what would be found anew.
TEST(Tracker, WhatIsKeptIsThatOfTheModel) {
  const std::vector<image::Image> pictures = halves_at_rest(20);
  vectorize::Options cold = cold_options();
  cold.max_control_points = 700;
  Tracker tracker(cold, {});
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    std::optional<Motion> motion;
    if (i > 0) motion = motion_between(pictures[i - 1], pictures[i]);
    const document::FrameModel model = tracker.next(pictures[i], motion ? &*motion : nullptr);
    const auto placed =
        fit::place_basis(std::make_shared<const spline::Basis>(model.space), model.displacement);
    std::vector<float> anew(pictures[i].samples.size());
    spline::surface_at_pixels<float>(placed->values(), {model.colour, model.channels}, anew);
    std::size_t other = 0;  // on the other side of a feature, by less than places are told to
    for (std::size_t n = 0; n < anew.size(); ++n)
      other += std::abs(anew[n] - tracker.surface()->colours[n]) > 0.2F ? 1 : 0;
    EXPECT_LE(other, anew.size() / 5000) << i;
  }
}

/// Colours change where everything has been at rest, but no edge does.
TEST(Tracker, RestEndsWithTheFirstChange) {
  std::vector<image::Image> pictures = halves_at_rest(15);
  for (int y = 0; y < 96; ++y) {
    for (int x = 144; x < 240; ++x)
      pictures.back().at(x, y, 1) *= 1 - 0.2F * std::clamp(static_cast<float>(x - 144) / 60, 0.0F, 1.0F);
  }
  const std::vector<FrameReport> reports = track(pictures, {}, 1).reports;
  ASSERT_EQ(reports.back().start, Start::kWarm);
  EXPECT_EQ(reports.back().changes.repairs, 0);
  EXPECT_GT(reports.back().psnr, reports[13].psnr - 2);
}

TEST(Tracker, RestDoesNotDependOnThreads) {
  const auto run = [](int threads) {
    const ThreadCap cap(threads);
    return track(halves_at_rest(14), {}, 1).models.back();
  };
  const document::FrameModel one = run(1);
  const document::FrameModel four = run(4);
  EXPECT_EQ(one.colour, four.colour);
  EXPECT_EQ(one.displacement, four.displacement);
}

TEST(Tracker, ColoursStayUntilTheBestAreAStepAway) {
  TrackOptions options{.rework_interval = 100};
  options.delta_coarseness *= 1.5;  // a picture as clear as this has finer steps than usual
  const double share = share_of_changed_colours(options);
  options.temporal_weight = 0;
  options.reluctance = 0;
  EXPECT_LT(share, 0.03);
  EXPECT_GT(share_of_changed_colours(options), 1.5 * share);
}

/// Noise that the surface cannot hold is what the steps are measured by, and documents have the same ones.
TEST(Tracker, ColoursAreAsCoarseAsWhatIsMissed) {
  for (const auto& [deviation, step] : std::vector<std::pair<float, double>>{{0.1F, 2}, {8, 3}, {24, 4}}) {
    std::vector<image::Image> pictures(4, scene(40, 36));
    std::mt19937 random(20261125);
    std::normal_distribution<float> noise(0, deviation);
    for (image::Image& picture : pictures) {
      for (float& s : picture.samples) s = std::clamp(128 + 0.3F * (s - 128) + noise(random), 0.0F, 255.0F);
    }
    const Tracked run = track(pictures, {});
    document::SequenceInfo info;
    info.width = pictures[0].width;
    info.height = pictures[0].height;
    info.channels = pictures[0].channels;
    std::ostringstream out;
    document::Writer writer(out, info);
    for (std::size_t i = 0; i < run.models.size(); ++i) {
      document::FrameModel model = run.models[i];
      model.pts = static_cast<std::int64_t>(i);
      const document::FrameModel stored = writer.append(model);
      if (i == 0) continue;
      EXPECT_EQ(model.colour_step, step) << deviation;
      EXPECT_EQ(stored.colour_step, step) << deviation;
      EXPECT_EQ(stored.colour, model.colour) << deviation << ", frame " << i;
      for (const double c : model.colour) ASSERT_EQ(c, step * std::round(c / step)) << deviation;
    }
  }
}

TEST(Tracker, NoFrameHasMoreControlPointsThanAllowed) {
  std::vector<image::Image> pictures = moving(12);
  for (std::size_t t = 0; t < pictures.size(); ++t) {  // more to show than the points are enough for
    for (std::size_t i = 0; i < pictures[t].samples.size(); ++i) {
      const double x = static_cast<double>(i / 3 % 96) - 2.5 * static_cast<double>(t);
      const auto y = static_cast<double>(i / 3 / 96);
      pictures[t].samples[i] += static_cast<float>(20 * std::sin(0.4 * x) * std::cos(0.3 * y + 0.01 * x * y));
    }
  }
  const Tracked run = track(pictures, {.drift = 100}, 0);
  std::size_t most = 0;
  for (const FrameReport& report : run.reports) {
    EXPECT_LE(report.control_points, 400U);
    most = std::max(most, report.control_points);
  }
  EXPECT_GT(most, 390U);
}

TEST(Tracker, WithoutWarmStartFramesAreThoseOfTheirPictures) {
  const std::vector<image::Image> pictures = moving(3);
  const Tracked run = track(pictures, {.warm_start = false});
  vectorize::Options cold = cold_options();
  cold.max_control_points = 400;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    EXPECT_NE(run.reports[i].start, Start::kWarm);
    EXPECT_TRUE(run.models[i].keyframe);
    std::vector<double> colour = vectorize::vectorize_picture(pictures[i], cold).model.colour;
    document::round_colours(colour, TrackOptions{}.colour_step);
    EXPECT_EQ(run.models[i].colour, colour);
  }
}

TEST(Tracker, AColdFrameMadeAheadChangesNothing) {
  const std::vector<image::Image> pictures = moving(5);
  vectorize::Options cold = cold_options();
  cold.max_control_points = 400;
  const TrackOptions options{.keyframe_interval = 3};
  const Tracked run = track(pictures, options);
  Tracker tracker(cold, options);
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    // The second and others are warm: theirs is left alone.
    std::shared_ptr<ColdFrame> ahead = make_cold_frame(pictures[i], {cold}, TrackOptions{}.colour_step);
    std::unique_ptr<Motion> motion;
    if (i > 0) motion = std::make_unique<Motion>(motion_between(pictures[i - 1], pictures[i]));
    FrameReport report;
    const document::FrameModel model =
        tracker.next(pictures[i], motion.get(), &report, {std::move(ahead), nullptr});
    EXPECT_EQ(report.start, run.reports[i].start);
    EXPECT_EQ(model.colour, run.models[i].colour) << i;
    EXPECT_EQ(model.displacement, run.models[i].displacement) << i;
  }
}

TEST(Tracker, AGroupDoesNotKnowWhatCameBefore) {
  const std::vector<image::Image> scene = moving(4);
  vectorize::Options cold = cold_options();
  cold.max_control_points = 400;
  Tracker fresh(cold, {});
  Tracker used(cold, {});
  image::Image other = image::make_image(96, 72, 3);
  for (std::size_t i = 0; i < other.samples.size(); ++i) other.samples[i] = static_cast<float>(i * 37 % 251);
  used.next(other, nullptr);
  image::Image nearly_the_same = other;
  nearly_the_same.samples[0] += 1;
  const Motion nothing_moves = motion_between(other, nearly_the_same);
  used.next(nearly_the_same, &nothing_moves);
  for (std::size_t i = 0; i < scene.size(); ++i) {
    std::unique_ptr<Motion> motion;
    if (i > 0) motion = std::make_unique<Motion>(motion_between(scene[i - 1], scene[i]));
    const document::FrameModel a = used.next(scene[i], motion.get()), b = fresh.next(scene[i], motion.get());
    EXPECT_EQ(a.colour, b.colour) << i;
    EXPECT_EQ(a.displacement, b.displacement) << i;
    EXPECT_EQ(a.space->mesh().faces, b.space->mesh().faces) << i;
  }
}

TEST(Tracker, RefusesPicturesThatAreNotFinite) {
  std::vector<image::Image> scene = moving(3);
  Tracker tracker(cold_options(), {});
  tracker.next(scene[0], nullptr);
  const Motion motion = motion_between(scene[0], scene[1]);
  image::Image broken = scene[1];
  broken.samples[100] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(tracker.next(broken, &motion), Error);
  FrameReport report;
  tracker.next(scene[1], &motion, &report);
  EXPECT_GT(report.psnr, 20) << "it goes on from the frame before";
}

TEST(Tracker, CutsAndIntervalsStartGroups) {
  std::vector<image::Image> pictures = moving(3);
  image::Image other = scene(70, 20);
  for (std::size_t i = 0; i < other.samples.size(); ++i) {
    const auto x = static_cast<double>(i / 3 % 96);
    const auto y = static_cast<double>(i / 3 / 96);
    other.samples[i] = static_cast<float>(128 + 100 * std::sin(0.5 * x) * std::cos(0.4 * y));
  }
  pictures.push_back(other);
  const Tracked run = track(pictures, {.keyframe_interval = 2});
  EXPECT_EQ(run.reports[1].start, Start::kWarm);
  EXPECT_EQ(run.reports[2].start, Start::kInterval);
  EXPECT_EQ(run.reports[3].start, Start::kCut);
}

/// A frame that comes out warm although a cold one was made.
bool made_in_vain(const FrameReport& report) {
  return report.start == Start::kWarm &&
         std::ranges::any_of(report.milliseconds, [](const auto& part) { return part.first == "cold"; });
}

TEST(Tracker, APictureThatBecomesHarderIsNoReasonToStartAnew) {
  std::vector<image::Image> pictures(8, image::make_image(96, 72, 3));
  for (std::size_t t = 0; t < pictures.size(); ++t) {  // waves get higher
    for (std::size_t i = 0; i < pictures[t].samples.size(); ++i) {
      const double x = static_cast<double>(i / 3 % 96) - 1.3 * static_cast<double>(t);
      const double y = static_cast<double>(i / 3 / 96) - 0.7 * static_cast<double>(t);
      const double waves = std::sin(0.8 * x + 0.2 * y) * std::cos(0.7 * y) + std::sin(0.05 * x * y);
      pictures[t].samples[i] = static_cast<float>(120 + 4 * (1 + double(t)) * waves);
    }
  }
  const Tracked run = track(pictures, {.drift = 1}, 0);
  EXPECT_LT(run.reports.back().psnr, run.reports.front().psnr - 3);
  for (const FrameReport& report : run.reports) EXPECT_FALSE(made_in_vain(report));
}

/// Out of a grey that few knots are enough for.
std::vector<image::Image> fade_in() {
  std::vector<image::Image> pictures(8, scene(40, 36));
  for (std::size_t t = 0; t < pictures.size(); ++t) {
    for (float& v : pictures[t].samples) v = 128 + (v - 128) * (0.02F + 0.14F * static_cast<float>(t));
  }
  return pictures;
}

TEST(Tracker, AModelThatHasBecomeTooSmallIsMadeAnew) {
  const Tracked run = track(fade_in(), {.scene_threshold = 1, .drift = 1, .growth = 0}, 1);
  EXPECT_LT(run.reports.front().control_points, 100U);
  EXPECT_GT(std::ranges::max(run.reports, {}, &FrameReport::control_points).control_points, 200U);
  EXPECT_TRUE(std::ranges::any_of(run.reports, [](const auto& r) { return r.start == Start::kDrift; }));
}

TEST(Tracker, AFrameIsMadeAnewWhenThatPromisesMoreThoughNothingFell) {
  TrackOptions options{.scene_threshold = 1, .drift = 100, .look_interval = 4, .growth = 0};
  const Tracked run = track(fade_in(), options, 1);
  for (std::size_t i = 1; i < 4; ++i) EXPECT_EQ(run.reports[i].start, Start::kWarm) << i;
  EXPECT_EQ(run.reports[4].start, Start::kDrift);
  const auto is_cold = [](const auto& lap) { return lap.first == "cold"; };
  EXPECT_EQ(std::ranges::count_if(run.reports[4].milliseconds, is_cold), 1);  // its time counts once
  options.look_interval = 100;
  const Tracked never = track(fade_in(), options, 1);
  for (std::size_t i = 1; i < 8; ++i) EXPECT_EQ(never.reports[i].start, Start::kWarm) << i;
}

/// A picture at rest without features, with noise that knots would go after.
std::vector<image::Image> noise_at_rest() {
  std::vector<image::Image> pictures;
  for (unsigned i = 0; i < 7; ++i) {
    pictures.push_back(scene(-100, -100));
    std::mt19937 random(i);
    for (float& sample : pictures.back().samples) sample += static_cast<float>(random() % 13) - 6;
  }
  return pictures;
}

/// Whether the knots of a frame are elsewhere than those of the frame before.
bool has_moved_knots(const Tracked& run, std::size_t frame) {
  const auto positions = [](const document::FrameModel& model) {
    std::vector<Vec2> result;
    for (const mesh::Knot& k : model.space->mesh().knots) result.push_back(k.position);
    return result;
  };
  return positions(run.models[frame]) != positions(run.models[frame - 1]);
}

TEST(Tracker, BetweenReworksKnotsOnlyFollowTheMotion) {
  const Tracked run = track(noise_at_rest(), {.rework_interval = 3, .mend_below = 100}, 0);
  for (std::size_t i = 1; i < run.models.size(); ++i) {
    EXPECT_EQ(run.reports[i].changes.repairs, 0);
    // The mesh of the cold frame is reworked for the next, and so is every third after it.
    EXPECT_EQ(has_moved_knots(run, i), i % 3 == 1) << i;
  }
}

TEST(Tracker, NoFrameWaitsForTheMeshOfTheNext) {
  const auto reworked = [](const FrameReport& report) {
    return std::ranges::any_of(report.milliseconds, [](const auto& lap) { return lap.first == "settle"; });
  };
  const std::vector<image::Image> pictures = moving(3);
  const Tracked run = track({pictures[0], pictures[0], pictures[1], pictures[2]}, {.rework_interval = 1});
  EXPECT_FALSE(reworked(run.reports[0])) << "there may be no other frame";
  EXPECT_FALSE(reworked(run.reports[1])) << "it has the model of the first";
  EXPECT_TRUE(reworked(run.reports[2]));
  EXPECT_TRUE(reworked(run.reports[3]));
}

TEST(Tracker, AFrameThatFellIsMendedForTheNext) {
  TrackOptions options{.rework_interval = 100, .most_repairs = 0, .mend_below = -100};
  const Tracked always = track(noise_at_rest(), options, 0);
  options.mend_below = 100;
  const Tracked never = track(noise_at_rest(), options, 0);
  for (std::size_t i = 2; i < always.models.size(); ++i) {
    EXPECT_TRUE(has_moved_knots(always, i)) << i;
    EXPECT_FALSE(has_moved_knots(never, i)) << i;
  }
}

TEST(Tracker, WhatFallsAllTheTimeIsRepairedLessOften) {
  const auto repairs = [](double patience, double drift) {
    // Each frame is harder than the one before; none is made anew.
    TrackOptions options{.scene_threshold = 1, .drift = drift, .restart_gain = 100, .growth = 0};
    options.repair_below = 0.01;
    options.repair_patience = patience;
    int count = 0;
    for (const FrameReport& report : track(fade_in(), options, 1).reports) count += report.changes.repairs;
    return count;
  };
  EXPECT_EQ(repairs(1e9, 100), 1);
  EXPECT_GT(repairs(0, 100), 3);
  EXPECT_GT(repairs(1e9, 0.01), 3) << "before a cold frame is looked for";
}

TEST(Tracker, CurvesAreBentEverySoManyFrames) {
  const auto bent = [](const FrameReport& report) {
    return std::ranges::any_of(report.milliseconds, [](const auto& lap) { return lap.first == "geometry"; });
  };
  const std::vector<image::Image> pictures = moving(7);
  TrackOptions options{
      .drift = 100, .bend_interval = 3, .curve_error = 0, .repair_below = 100, .birth_interval = 0};
  const Tracked run = track(pictures, options);
  // The first warm frame is looked at, and every third after it.
  for (std::size_t i = 1; i < pictures.size(); ++i) EXPECT_EQ(bent(run.reports[i]), i % 3 == 1) << i;
  // After the first frame that is worse than the one before, all are.
  options.repair_below = -100;
  options.most_repairs = 0;
  const Tracked falling = track(pictures, options);
  for (std::size_t i = 1; i < pictures.size(); ++i) EXPECT_EQ(bent(falling.reports[i]), i != 2) << i;
}

TEST(Tracker, NeighboursOfNewKnotsMoveOnlyWhereMuchIsNew) {
  const std::vector<image::Image> pictures = moving(5);
  const Tracked never = track(pictures, {.much_new = 1}, 0);
  const Tracked always = track(pictures, {.much_new = 0}, 0);
  EXPECT_TRUE(std::ranges::any_of(always.reports, [](const auto& r) { return r.changes.inserted > 0; }));
  EXPECT_NE(always.models.back().colour, never.models.back().colour);
  EXPECT_EQ(track(pictures, {.much_new = 2}, 0).models.back().colour, never.models.back().colour);
}

TEST(Tracker, AGroupGrowsWithItsContentAndNoFurther) {
  const TrackOptions options{.scene_threshold = 1, .drift = 100, .growth = 0.3};
  std::vector<image::Image> pictures = fade_in();
  const Tracked run = track(pictures, options, 1);
  EXPECT_LT(run.reports.front().control_points, 100U);
  EXPECT_GT(run.reports.back().control_points, 2 * run.reports.front().control_points);
  const Tracked slow = track(pictures, {.scene_threshold = 1, .drift = 100, .growth = 0.01}, 1);
  EXPECT_GT(slow.reports.back().control_points, slow.reports.front().control_points) << "by a knot at least";
  const Tracked bounded = track(pictures, options, 0);
  for (const FrameReport& report : bounded.reports) EXPECT_LE(report.control_points, 400U);
  // What is good enough stays as it is.
  const Tracked still = track(std::vector<image::Image>(6, scene(40, 36)), options, 8);
  for (const FrameReport& report : still.reports)
    EXPECT_EQ(report.control_points, still.reports[0].control_points);
}

TEST(Tracker, SameBitsForAnyNumberOfThreads) {
  const std::vector<image::Image> pictures = moving(4);
  const auto with = [&](int threads) {
    const ThreadCap cap(threads);
    return track(pictures, {});
  };
  const Tracked one = with(1);
  for (const int threads : {2, 3}) {
    const Tracked more = with(threads);
    for (std::size_t i = 0; i < pictures.size(); ++i) {
      EXPECT_EQ(one.models[i].colour, more.models[i].colour);
      EXPECT_EQ(one.models[i].displacement, more.models[i].displacement);
    }
  }
}

TEST(Tracker, IdsAreNotUsedAgain) {
  const Tracked run = track(moving(6), {});
  std::map<std::uint32_t, std::size_t> last_seen;
  for (std::size_t i = 0; i < run.models.size(); ++i) {
    for (const mesh::Knot& k : run.models[i].space->mesh().knots) {
      const auto id = static_cast<std::uint32_t>(k.id);
      if (i > 0 && last_seen.count(id)) {
        EXPECT_EQ(last_seen[id], i - 1) << id;
      }
      last_seen[id] = i;
    }
  }
}

/// The largest root mean square error of the blocks of 16x16 pixels.
double worst_block(const image::Image& picture, const spline::PixelSurface& surface) {
  double worst = 0;
  for (int y = 0; y + 16 <= picture.height; y += 16) {
    for (int x = 0; x + 16 <= picture.width; x += 16) {
      double sum = 0;
      for (int i = 0; i < 16 * 16 * 3; ++i) {
        const auto n = static_cast<std::size_t>(((y + i / 48) * picture.width + x) * 3 + i % 48);
        const double d = static_cast<double>(picture.samples[n] - surface.colours[n]);
        sum += d * d;
      }
      worst = std::max(worst, std::sqrt(sum / 256));
    }
  }
  return worst;
}

/// A soft spot that is there by a share, on a ground so smooth that the mean error is small without it.
image::Image soft_spot(double share) {
  image::Image picture = image::make_image(240, 160, 3);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double spot = 90 * share / (1 + std::exp((std::hypot(x - 150, y - 90) - 14) / 1.5));
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(90 + 0.1 * x + 0.1 * y + spot);
    }
  }
  return picture;
}

/// The spot fades in from frame 4 on, for so many frames, and then stays. @return worst_block() by frame.
std::vector<double> worst_blocks_of_fade(const vectorize::Options& cold, const TrackOptions& options,
                                         int fade) {
  Tracker tracker(cold, options);
  std::optional<image::Image> before;
  std::vector<double> worst;
  for (int frame = 0; frame < 24; ++frame) {
    image::Image picture = soft_spot(std::clamp((frame - 4.0) / fade, 0.0, 1.0));
    std::optional<Motion> motion;
    if (before) motion = motion_between(*before, picture);
    tracker.next(picture, motion ? &*motion : nullptr, nullptr);
    worst.push_back(worst_block(picture, *tracker.surface()));
    before = std::move(picture);
  }
  return worst;
}

constexpr double kBlockBound = 2 * 4;  // of the default options

TEST(Tracker, WhatFadesInIsNotLeftOutThoughTheMeanIsMet) {
  EXPECT_LT(worst_blocks_of_fade({}, {}, 12).back(), kBlockBound);
  vectorize::Options by_mean;
  by_mean.block_error = 0;
  EXPECT_GT(worst_blocks_of_fade(by_mean, {}, 12).back(), 2 * kBlockBound);
}

TEST(Tracker, APictureThatIsRepeatedIsMadeAnewIfItsModelIsBad) {
  TrackOptions options;
  options.drift = 100;  // looks only after look_interval frames, long after the last change
  const std::vector<double> worst = worst_blocks_of_fade({}, options, 3);
  constexpr std::size_t kStays = 7;  // from this frame on
  EXPECT_GT(worst[kStays + 4], 2 * kBlockBound);
  EXPECT_LT(worst.back(), kBlockBound);
  for (std::size_t i = kStays + 1; i < worst.size(); ++i) {
    EXPECT_TRUE(worst[i] == worst[i - 1] || worst[i] < kBlockBound) << i;
  }
}

TEST(Tracker, APictureThatIsHeldIsLookedAtOnceForASmallGain) {
  TrackOptions options;
  options.drift = 100;
  options.look_interval = 1000;
  options.restart_gain = 1000;
  const std::vector<double> worst = worst_blocks_of_fade({}, options, 3);
  constexpr std::size_t kStays = 7;  // from this frame on
  EXPECT_GT(worst[kStays + 3], kBlockBound) << "it is not held yet";
  EXPECT_LT(worst[kStays + 6], kBlockBound);
  EXPECT_EQ(worst.back(), worst[kStays + 6]) << "once";
}

TEST(Tracker, WrongOptionsAreRefused) {
  EXPECT_THROW(Tracker({}, {.keyframe_interval = 0}), Error);
  for (const double bad : {-0.5, std::nan("")}) {
    EXPECT_THROW(Tracker({}, {.temporal_weight = bad}), Error);
    EXPECT_THROW(Tracker({}, {.scene_threshold = bad}), Error);
  }
  EXPECT_THROW(Tracker({}, {.temporal_weight = 1.5}), Error);
  EXPECT_THROW(Tracker({}, {.look_interval = 0}), Error);
  EXPECT_THROW(Tracker({}, {.rework_interval = 0}), Error);
  EXPECT_THROW(Tracker({}, {.bend_interval = 0}), Error);
  EXPECT_THROW(Tracker({}, {.repair_patience = -1}), Error);
  EXPECT_THROW(Tracker({}, {.knot_bits = -1}), Error);
  EXPECT_THROW(Tracker({}, {.knot_bits = 15}), Error);
  EXPECT_THROW(Tracker({}, {.displacement_step = 0}), Error);
  EXPECT_THROW(Tracker({}, {.colour_step = 0}), Error);
  EXPECT_THROW(Tracker({}, {.delta_coarseness = -1}), Error);
}

TEST(MotionBetween, PicturesOfOtherShapeAreRefusedWhateverTheirSamples) {
  const image::Image flat = image::make_image(8, 8, 1);
  EXPECT_TRUE(motion_between(flat, flat).repeated);
  EXPECT_THROW(motion_between(flat, image::make_image(8, 4, 2)), Error);
  EXPECT_THROW(motion_between(flat, image::make_image(4, 16, 1)), Error);
}

}  // namespace
}  // namespace knotreel::track
