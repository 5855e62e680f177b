// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/finish.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "knotreel/fit/squared_errors.h"
#include "vectorize/rounds.h"
#include "vectorize/scenes.h"
#include "vectorize/start.h"

namespace knotreel::vectorize {
namespace {

/// A ring and a bar on plain ground.
image::Image plain_shapes() {
  return draw(120, 90, 3, [](double x, double y) {
    if (std::abs(std::hypot(x - 45, y - 42) - 24) < 6) return Colour{200, 30, 60};
    if (std::abs(0.9 * (x - 92) + 0.44 * (y - 45)) < 7 && std::abs(y - 45) < 33) return Colour{20, 80, 150};
    return Colour{240, 235, 220};
  });
}

TEST(Finish, AnOutlookLeavesNoTrace) {
  const image::Image picture = plain_shapes();
  const Options options;
  const Observer observer;
  RunLog log(picture, observer);
  log.begin_round("round 1");
  const auto start = make_start({picture, picture}, options, {3000, 3000}, log);
  Samples& samples = *start->samples;
  Draft draft;
  Rounds rounds(options, *start->target, samples, 3000, log, draft);
  rounds.first(std::move(*start->mesh), start->mapped.knots);

  const std::vector<Vec2> places = samples.places();
  const std::vector<float> weights(samples.weights().begin(), samples.weights().end());
  const std::vector<float> colours = samples.colours().samples;
  const std::vector<float> now =
      fit::squared_errors(draft.surface.fit.residual, samples.steering().weights, *samples.steering().image);
  const Outlook then = outlook(options, samples, log, draft);
  EXPECT_EQ(samples.places(), places);
  EXPECT_TRUE(std::equal(weights.begin(), weights.end(), samples.weights().begin(), samples.weights().end()));
  EXPECT_EQ(samples.colours().samples, colours);

  ASSERT_EQ(then.squared_errors.size(), picture.pixel_count());
  EXPECT_GT(then.mec, 0);
  EXPECT_LT(then.mec, 1);
  const auto mean = [](const std::vector<float>& errors) {
    return std::accumulate(errors.begin(), errors.end(), 0.0) / static_cast<double>(errors.size());
  };
  EXPECT_LT(mean(then.squared_errors), 0.5 * mean(now))
      << "pixels beside features are where they will be drawn";
}

TEST(Finish, FewRoundsForWhatTheEndMends) {
  // Black stars on white: the geometry takes their tips a pixel or two from where the parametrization has
  // them.
  const image::Image picture = draw(200, 100, 1, [](double x, double y) {
    const double u = std::fmod(x, 100) - 50.3;
    const double v = y - 48.8;
    const double tip = 2 * std::numbers::pi / 5;
    const double angle = std::abs(std::remainder(std::atan2(v, u) - 0.3, tip));
    const double r = std::hypot(u, v);
    // From a tip at (40, 0) to the notch beside it.
    const double notch_x = 16 * std::cos(tip / 2);
    const double notch_y = 16 * std::sin(tip / 2);
    const double inside = (40 - r * std::cos(angle)) * notch_y - r * std::sin(angle) * (40 - notch_x);
    return Colour{inside > 0 ? 20.0 : 240.0};
  });
  const Vectorization v = vectorize_picture(picture, {});
  EXPECT_LE(v.report.rounds.size(), 4U) << "two rounds, descent, final";
  EXPECT_GT(psnr(picture, v.model), 40);
}

}  // namespace
}  // namespace knotreel::vectorize
