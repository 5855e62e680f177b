// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/births.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "knotreel/mesh/insert_polylines.h"
#include "knotreel/track/tracker.h"
#include "track/cold_frame.h"
#include "track/edge_picture.h"

namespace knotreel::track {
namespace {

image::Image flat() {
  image::Image image = image::make_image(96, 64, 1);
  std::fill(image.samples.begin(), image.samples.end(), 90.0F);
  return image;
}

/// What a smooth surface misses: the steep places.
std::vector<float> misses(const image::Image& picture) {
  std::vector<float> errors(picture.samples.size(), 0.1F);
  for (std::size_t i = 1; i < errors.size(); ++i) {
    const float d = picture.samples[i] - picture.samples[i - 1];
    errors[i] += d * d;
  }
  return errors;
}

/// Features of a picture that the model of another one lacks, which misses so much of it.
std::vector<std::vector<Vec2>> missing(const image::Image& modelled, const image::Image& picture,
                                       const std::vector<float>& squared_errors, double most_length = 1000) {
  const vectorize::Options options;
  const auto cold = make_cold_frame(modelled, {options}, 2);
  return missing_features(*cold->frame.basis, cold->frame.displacement, cold->frame.seen, picture,
                          squared_errors, options.detect, most_length);
}

std::vector<std::vector<Vec2>> missing(const image::Image& modelled, const image::Image& picture,
                                       double most_length = 1000) {
  return missing(modelled, picture, misses(picture), most_length);
}

TEST(Births, AnEdgeThatTheModelLacksIsFound) {
  const auto lines = missing(flat(), edge_at(48));
  ASSERT_EQ(lines.size(), 1U);
  for (const Vec2 p : lines[0]) EXPECT_NEAR(p.x + 0.3 * (p.y - 32), 48, 0.5);
  EXPECT_GT(norm(lines[0].back() - lines[0].front()), 40);
}

TEST(Births, AnEdgeThatTheModelHasIsNotFoundAgain) {
  EXPECT_TRUE(missing(edge_at(48), edge_at(48)).empty());
  EXPECT_TRUE(missing(edge_at(48), edge_at(50)).empty());
  EXPECT_FALSE(missing(edge_at(30), edge_at(60)).empty());
}

TEST(Births, WeakEdgesAndThoseWithoutRoomAreLeft) {
  image::Image weak = edge_at(48);
  for (float& v : weak.samples) v = 90 + 0.2F * (v - 90);
  EXPECT_TRUE(missing(flat(), weak).empty());
  EXPECT_TRUE(missing(flat(), edge_at(48), 20).empty());
}

TEST(Births, WhatIsMissedLessThanTheRestIsLeft) {
  const image::Image picture = edge_at(48);
  std::vector<float> errors = misses(picture);
  for (float& e : errors) e = 1 / (1 + e);
  EXPECT_TRUE(missing(flat(), picture, errors).empty());
}

image::Image disc(double radius) {
  image::Image picture = flat();
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const double away = std::hypot(x + 0.5 - 48.2, y + 0.5 - 31.7) - radius;
      picture.at(x, y, 0) += static_cast<float>(120 * std::clamp(0.5 - away, 0.0, 1.0));
    }
  }
  return picture;
}

TEST(Births, ARingIsOneCurveHoweverSmall) {
  for (const double radius : {5.5, 6.0, 7.0, 9.0, 15.0}) {
    const auto lines = missing(flat(), disc(radius));
    ASSERT_EQ(lines.size(), 1U) << radius;
    double length = 0;
    for (std::size_t i = 1; i < lines[0].size(); ++i) length += norm(lines[0][i] - lines[0][i - 1]);
    EXPECT_GT(length, 0.6 * 2 * 3.14159 * radius) << radius;
    EXPECT_GT(norm(lines[0].back() - lines[0].front()), 3) << "open: there is room between its ends";
  }
}

/// An edge over soft waves, which keep the knots busy.
image::Image fading_in(float share) {
  image::Image picture = edge_at(48);
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      float& v = picture.at(x, y, 0);
      v = 90 + share * (v - 90) +
          15 * std::sin(0.4F * static_cast<float>(x)) * std::cos(0.3F * static_cast<float>(y));
    }
  }
  return picture;
}

TEST(Births, AFeatureThatComesIntoAGroupIsSharp) {
  vectorize::Options options;
  options.feature_share = 1;  // the picture is small
  TrackOptions track;
  track.birth_interval = 4;
  track.drift = 100;
  track.scene_threshold = 10;
  Tracker tracker(options, track);
  image::Image before;
  FrameReport report;
  std::size_t born = 0;
  document::FrameModel model;
  for (int i = 0; i < 16; ++i) {
    const image::Image picture = fading_in(std::min(1.0F, static_cast<float>(i) / 15));
    const Motion motion = i > 0 ? motion_between(before, picture) : Motion();
    model = tracker.next(picture, i > 0 ? &motion : nullptr, &report);
    ASSERT_EQ(report.start, i > 0 ? Start::kWarm : Start::kFirst) << i;
    ASSERT_EQ(mesh::find_defect(model.space->mesh()), std::nullopt) << i;
    EXPECT_TRUE(i > 0 || model.space->mesh().segments.empty());
    born += report.changes.features_born;
    before = picture;
  }
  EXPECT_GE(born, 1U);
  EXPECT_FALSE(model.space->mesh().segments.empty());
  EXPECT_GT(report.psnr, 32);
}

TEST(Births, AreForgottenWhenAGroupStarts) {
  vectorize::Options options;
  options.feature_share = 1;
  TrackOptions track;
  track.birth_interval = 2;
  track.drift = 100;
  track.scene_threshold = 10;
  Tracker fresh(options, track);
  Tracker used(options, track);
  FrameReport report;
  for (int i = 0; i < 16 && report.changes.features_born == 0; ++i) {
    const image::Image picture = fading_in(static_cast<float>(i) / 15);
    const image::Image before = fading_in(static_cast<float>(std::max(0, i - 1)) / 15);
    const Motion motion = motion_between(before, picture);
    used.next(picture, i > 0 ? &motion : nullptr, &report);
  }
  ASSERT_GT(report.changes.features_born, 0U);
  const image::Image first = edge_at(40);
  image::Image second = first;
  second.samples[0] += 1;
  const Motion motion = motion_between(first, second);
  for (Tracker* tracker : {&used, &fresh}) tracker->next(first, nullptr);
  const document::FrameModel after_births = used.next(second, &motion);
  const document::FrameModel expected = fresh.next(second, &motion);
  ASSERT_FALSE(expected.space->mesh().segments.empty());
  EXPECT_EQ(after_births.displacement, expected.displacement);
  EXPECT_EQ(after_births.colour, expected.colour);
}

}  // namespace
}  // namespace knotreel::track
