// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/fine_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "knotreel/image/enlarge.h"
#include "knotreel/spline/basis.h"
#include "knotreel/vectorize/vectorize.h"
#include "vectorize/rounds.h"
#include "vectorize/scenes.h"
#include "vectorize/start.h"

namespace knotreel::vectorize {
namespace {

constexpr int kWidth = 132, kHeight = 96;

/// Strokes of one to two pixels on plain ground, as of small letters: rings and bars at all angles.
image::Image thin_strokes(int scale) {
  return draw(scale * kWidth, scale * kHeight, 3, [&](double px, double py) {
    const double x = px / scale, y = py / scale;
    if (std::abs(std::hypot(x - 30, y - 30) - 14) < 0.75) return Colour{30, 30, 40};
    if (std::abs(std::hypot(x - 30, y - 30) - 8) < 0.6) return Colour{150, 20, 30};
    for (int bar = 0; bar < 5; ++bar) {
      const double angle = 0.25 + 0.55 * bar, cx = 66 + 14 * bar, cy = 34 + 8 * (bar % 2);
      const double along = (x - cx) * std::cos(angle) + (y - cy) * std::sin(angle);
      const double across = (y - cy) * std::cos(angle) - (x - cx) * std::sin(angle);
      if (std::abs(along) < 16 && std::abs(across) < 0.5 + 0.1 * bar) return Colour{20, 60, 140};
    }
    if (std::abs(y - 78 - 5 * std::sin(x / 9)) < 0.8 && x > 8 && x < 124) return Colour{0, 0, 0};
    return Colour{245, 245, 240};
  });
}

TEST(FineGrid, ThinStrokesHaveTwoSides) {
  const image::Image picture = thin_strokes(1);
  Options options;
  const Vectorization fine = vectorize_picture(picture, options);
  options.fine_grid = FineGrid::kNone;
  const Vectorization plain = vectorize_picture(picture, options);
  EXPECT_TRUE(fine.report.fine_grid);
  EXPECT_FALSE(plain.report.fine_grid);
  const image::Image large = thin_strokes(4);
  const auto enlarged = [&](const Vectorization& v) {
    return image::compare_images(rendered(v.model, {.width = 4 * kWidth, .height = 4 * kHeight}), large).psnr;
  };
  EXPECT_GT(psnr(picture, fine.model), psnr(picture, plain.model) + 3);
  EXPECT_GT(enlarged(fine), enlarged(plain) + 2);
}

/// Notes on lines: most edges are between pixels of two colours, as those of a printed grid.
image::Image score() {
  return draw(kWidth, kHeight, 1, [](double x, double y) {
    for (int note = 0; note < 6; ++note) {
      if (std::hypot((x - 18 - 19.3 * note) / 1.3, y - 16.2 - 10 * ((note * 3) % 7)) < 2.7) return Colour{0};
    }
    return Colour{int(y) % 10 < 2 && y > 10 && y < 84 ? 90.0 : 255.0};
  });
}

TEST(FineGrid, IsAlsoForWhatIsBetweenEdgesInSteps) {
  const image::Image picture = score();
  Options options;
  const Vectorization fine = vectorize_picture(picture, options);
  options.fine_grid = FineGrid::kNone;
  const Vectorization plain = vectorize_picture(picture, options);
  EXPECT_TRUE(fine.report.fine_grid);
  EXPECT_GT(psnr(picture, fine.model), psnr(picture, plain.model) + 2);
}

TEST(FineGrid, IsForDrawingsOfModestSize) {
  const Options options;
  EXPECT_TRUE(wants_fine_grid(thin_strokes(1), options));
  image::Image noise = thin_strokes(1);
  std::mt19937 random(5);
  for (float& sample : noise.samples) sample += float(random() % 9);
  EXPECT_FALSE(wants_fine_grid(noise, options));
  Options all = options;
  all.fine_grid = FineGrid::kAll;
  EXPECT_TRUE(wants_fine_grid(noise, all));
  EXPECT_FALSE(wants_fine_grid(image::make_image(200, 100, 1), options)) << "where there is nothing";
  image::Image large = image::make_image(1600, 1200, 1);
  for (std::size_t i = 0; i < large.samples.size(); ++i)
    large.samples[i] = i % 1600 < 800 ? 20.0F : i % 1600 == 800 ? 100.0F : 220.0F;
  EXPECT_FALSE(wants_fine_grid(large, options));
  Options without = options;
  without.features = false;
  EXPECT_FALSE(wants_fine_grid(thin_strokes(1), without));
  for (const Options& none : {video_options(all), preset_options(Preset::kFast)})
    EXPECT_FALSE(wants_fine_grid(thin_strokes(1), none));
  EXPECT_TRUE(wants_fine_grid(thin_strokes(1), drawn_video_options(all)));
  EXPECT_FALSE(wants_fine_grid(noise, drawn_video_options(all)));
  EXPECT_FALSE(wants_fine_grid(thin_strokes(1), drawn_video_options(preset_options(Preset::kFast))));
}

TEST(FineGrid, NoisyDrawingsInVideosAreSmoothed) {
  const image::Image clean = thin_strokes(1);
  image::Image noisy = clean;
  std::mt19937 random(5);
  for (float& sample : noisy.samples) sample += float(random() % 5);
  const Options video = drawn_video_options(Options{});
  EXPECT_EQ(suited_to(clean, video).fine_smoothing, video.fine_smoothing);
  EXPECT_GT(suited_to(clean, video).drawn_threshold, 0);
  EXPECT_GT(suited_to(noisy, video).fine_smoothing, video.fine_smoothing);
  EXPECT_EQ(suited_to(noisy, video).drawn_threshold, 0) << "faint edges may be noise";
  EXPECT_EQ(suited_to(noisy, Options{}).fine_smoothing, Options{}.fine_smoothing) << "a still";
}

/// A picture on its way to the fine grid, with its features and first knots.
struct FineStart {
  static constexpr std::size_t kMost = 3000;  // control points

  explicit FineStart(const image::Image& picture) : enlarged(image::enlarge_twofold(picture)) {
    log.begin_round("round 1");
    start = make_start({enlarged, picture}, options, {kMost, kMost}, log);
  }

  const image::Image enlarged;
  const Options options = on_fine_grid(Options{});
  const Observer observer;
  RunLog log{enlarged, observer};
  std::unique_ptr<Start> start;
};

TEST(FineGrid, ThePictureGetsWhatTheGridHas) {
  const image::Image picture = thin_strokes(1);
  FineStart at_first(picture);
  const std::unique_ptr<Start>& start = at_first.start;
  Draft draft;
  Rounds rounds(at_first.options, *start->target, *start->samples, FineStart::kMost, at_first.log, draft);
  rounds.first(std::move(*start->mesh), start->mapped.knots);

  const Draft half = halved(draft);
  EXPECT_EQ(half.surface.space->mesh().width, kWidth);
  EXPECT_EQ(half.surface.space->mesh().height, kHeight);
  ASSERT_EQ(half.surface.space->function_count(), draft.surface.space->function_count());
  const spline::Basis fine_basis(draft.surface.space), half_basis(half.surface.space);
  std::mt19937 random(2);
  std::vector<spline::BasisValue> a, b;
  for (int i = 0; i < 300; ++i) {
    const Vec2 u{double(random() % 10000) * kWidth / 10000, double(random() % 10000) * kHeight / 10000};
    fine_basis.evaluate(2.0 * u, a);
    half_basis.evaluate(u, b);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k) {
      ASSERT_EQ(a[k].function, b[k].function);
      ASSERT_NEAR(a[k].value, b[k].value, 1e-9);
    }
  }

  features::ChainPoint& moved = start->mapped.faired.chains[0].points[3];
  moved.move_to(moved.position + Vec2{3, 2.5});
  const MappedPicture features = halved_features(start->mapped);
  EXPECT_EQ(features.knots.width, kWidth);
  EXPECT_EQ(features.parametrization.height, kHeight);
  for (std::size_t c = 0; c < features.faired.chains.size(); ++c) {
    const auto& points = features.faired.chains[c].points;
    for (std::size_t i = 0; i < points.size(); ++i)
      EXPECT_EQ(points[i].on_curve(), 0.5 * start->mapped.faired.chains[c].points[i].on_curve());
  }

  Halved on_picture(start->mapped, picture);
  const Samples& samples = on_picture.samples();
  ASSERT_EQ(samples.places().size(), picture.pixel_count());
  ASSERT_EQ(samples.curves().size(), start->samples->curves().size());
  for (std::size_t i = 0; i < samples.curves().size(); ++i) {
    const fit::CurvePoint &p = samples.curves()[i], &fine = start->samples->curves()[i];
    EXPECT_NEAR(norm(p.parameter - 0.5 * fine.parameter), 0, 1e-12);
    EXPECT_NEAR(norm(p.position - 0.5 * fine.position), 0, 1e-12);
  }
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const Vec2 place = samples.places()[std::size_t(y * kWidth + x)];
      Vec2 mean;
      for (const int row : {2 * y, 2 * y + 1}) {
        for (const int column : {2 * x, 2 * x + 1})
          mean = mean + 0.125 * start->samples->places()[std::size_t(row * 2 * kWidth + column)];
      }
      ASSERT_NEAR(norm(place - mean), 0, 1e-6);
    }
  }
}

TEST(Samples, PixelsThatNoFeatureCrossesAnyMoreHaveTheirColoursAgain) {
  const image::Image picture = thin_strokes(1);
  const FineStart at_first(picture);
  Halved on_picture(at_first.start->mapped, picture);
  Samples& samples = on_picture.samples();
  EXPECT_NE(samples.colours().samples, picture.samples);
  const image::Image once = samples.colours();
  std::vector<std::uint8_t> crossed(picture.pixel_count());
  for (std::size_t i = 0; i < crossed.size(); ++i) crossed[i] = samples.weights()[i] < 1 ? 1 : 0;
  const mesh::KnotMesh mesh = halved_features(at_first.start->mapped).knots;
  const std::vector<std::uint8_t> nothing(picture.pixel_count(), 0);

  const Samples::State before = samples.state();
  samples.move(samples.places(), nothing, mesh);
  EXPECT_EQ(samples.colours().samples, picture.samples);
  samples.restore(before);
  EXPECT_EQ(samples.colours().samples, once.samples);
  samples.move(samples.places(), nothing, mesh);
  EXPECT_EQ(samples.colours().samples, picture.samples);
  samples.move(samples.places(), crossed, mesh);
  EXPECT_EQ(samples.colours().samples, once.samples);
}

TEST(FineGrid, NoPartIsLeftOut) {
  // A ring, and a soft spot that is no feature and is lost in the mean.
  const image::Image picture = draw(160, 120, 1, [](double x, double y) {
    const double ring = std::abs(std::hypot(x - 110, y - 60) - 30);
    const double spot = std::hypot(x - 30, y - 30) / 5;
    return Colour{(ring < 1 ? 60 : 200) - 60 * std::exp(-spot * spot)};
  });
  const auto error_of_spot = [&](double block_error) {
    Options options;
    options.block_error = block_error;
    const Vectorization made = vectorize_picture(picture, options);
    EXPECT_TRUE(made.report.fine_grid);
    const image::Image drawn = rendered(made.model);
    double squared = 0;
    for (int y = 20; y < 40; ++y) {
      for (int x = 20; x < 40; ++x) squared += std::pow(drawn.at(x, y, 0) - picture.at(x, y, 0), 2);
    }
    return std::sqrt(squared / 400);
  };
  EXPECT_LT(error_of_spot(0.5), 0.6 * error_of_spot(0));
}

TEST(FineGrid, StagesShowThePictureThatTheyWorkOn) {
  const image::Image picture = thin_strokes(1);
  std::vector<std::string> fine, given;
  vectorize_picture(picture, {}, [&](const Progress& p) {
    ASSERT_TRUE(p.picture);
    (p.picture == &picture ? given : fine).push_back(p.stage);
    const int scale = p.picture == &picture ? 1 : 2;
    EXPECT_EQ(p.picture->width, scale * kWidth);
    EXPECT_TRUE(!p.detected || p.detected->width == scale * kWidth);
    EXPECT_TRUE(!p.model || p.model->space->mesh().width == scale * kWidth);
  });
  EXPECT_EQ(fine.front(), "features");
  EXPECT_EQ(given, std::vector<std::string>{"final"});
}

TEST(FineGrid, StepsAreToldInThePicture) {
  // A ring with mixed pixels, and a disc without any.
  const image::Image picture = draw(130, 80, 1, [](double x, double y) {
    if (std::abs(std::hypot(x - 35, y - 40) - 20) < 2) return Colour{20};
    const double column = std::floor(x) + 0.5, row = std::floor(y) + 0.5;
    return Colour{std::hypot(column - 95.3, row - 40.2) < 20 ? 40.0 : 230.0};
  });
  FineStart at_first(picture);
  const std::unique_ptr<Start>& start = at_first.start;
  ASSERT_EQ(start->mapped.faired.chains.size(), 3U);
  for (const features::Chain& chain : start->mapped.faired.chains)
    EXPECT_EQ(chain.stepped, chain.points.front().x > 130) << chain.points.front().x;
}

TEST(FineGrid, ErrorsOfPixelsAreThoseOfTheirQuarters) {
  EXPECT_EQ(on_fine_pixels({1, 2, 3, 4}, 2),
            (std::vector<float>{1, 1, 2, 2, 1, 1, 2, 2, 3, 3, 4, 4, 3, 3, 4, 4}));
}

}  // namespace
}  // namespace knotreel::vectorize
