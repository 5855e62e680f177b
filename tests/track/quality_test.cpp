// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "knotreel/document/stored_mesh.h"
#include "knotreel/image/metrics.h"
#include "knotreel/raster/render.h"
#include "knotreel/track/tracker.h"
#include "support/drawn_scene.h"
#include "track/cold_frame.h"

namespace knotreel::track {
namespace {

TEST(Quality, AsDrawnIsThatOfTheDrawing) {
  const image::Image picture = test::drawing(40, 40);
  vectorize::Options options = vectorize::video_options({});
  options.max_control_points = 300;
  const auto cold = make_cold_frame(picture, {options, nullptr, nullptr}, 0.25);
  image::Image drawn = image::make_image(picture.width, picture.height, picture.channels);
  drawn.samples = raster::render(model_of(cold->frame, picture.channels));
  const double expected = image::compare_images(picture, drawn).psnr;
  EXPECT_NEAR(psnr_as_drawn(cold->frame, picture), expected, 0.1) << "there samples are rounded";
}

TEST(Quality, PixelsOfLittleWeightDoNotCount) {
  const image::Image picture = image::make_image(4, 1, 1);
  const std::vector<float> residual{2, 2, 200, 2};
  EXPECT_NEAR(quality_of(residual, std::vector<float>{1, 1, 0, 1}, picture).mec, 2, 1e-9);
  EXPECT_NEAR(quality_of(residual, {}, picture).mec, 51.5, 1e-9);
  EXPECT_NEAR(quality_of(residual, std::vector<float>{1, 1, 0, 1}, picture).psnr, 20 * std::log10(255 / 2.0),
              1e-9);
}

TEST(ColdFrame, OfWhichTheFeaturesCannotBeStoredTellsThat) {
  const image::Image picture = test::drawing(40, 40);
  const vectorize::Options options = vectorize::video_options({});
  bool thrown = false;
  const auto throw_once = [&](const vectorize::Progress& progress) {
    if (progress.stage == "final" && !std::exchange(thrown, true))
      throw document::FlatFace("cannot store a frame: for a test");
  };
  MadeAhead ahead;
  ahead.cold = make_cold_frame(picture, {options, nullptr, nullptr}, 2, throw_once);
  ASSERT_TRUE(thrown);
  Tracker tracker(options, {});
  FrameReport report;
  const document::FrameModel model = tracker.next(picture, nullptr, &report, std::move(ahead));
  EXPECT_TRUE(report.features_dropped);
  EXPECT_TRUE(model.space->mesh().segments.empty());
  tracker.next(picture, nullptr, &report);
  EXPECT_FALSE(report.features_dropped);
}

}  // namespace
}  // namespace knotreel::track
