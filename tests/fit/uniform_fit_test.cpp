// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/uniform_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/image/metrics.h"
#include "knotreel/raster/render.h"

namespace knotreel::fit {
namespace {

image::Image picture(int width, int height, int channels, double (*f)(double, double, int)) {
  image::Image image = image::make_image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) {
        image.at(x, y, c) = static_cast<float>(f((x + 0.5) / width, (y + 0.5) / height, c));
      }
    }
  }
  return image;
}

image::Image rendered(const document::FrameModel& model) {
  const auto& mesh = model.space->mesh();
  image::Image image =
      image::make_image(static_cast<int>(mesh.width), static_cast<int>(mesh.height), model.channels);
  image.samples = raster::render(model);
  return image;
}

double smooth(double x, double y, int c) {
  return 120 + 90 * std::sin(4 * x + c) * std::cos(3 * y) + 20 * x * y;
}
double quadratic(double x, double y, int c) {
  return 30 + 100 * x * x - 40 * x * y + 60 * y * y + 10 * c;
}

class UniformFit : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Degree, UniformFit, ::testing::Values(1, 2, 3));

TEST_P(UniformFit, SmoothPicturesComeOutWell) {
  const image::Image image = picture(96, 64, 3, smooth);
  const auto model = fit_uniform(image, {.control_points = 300, .degree = GetParam()});
  EXPECT_NEAR(static_cast<double>(model.space->function_count()), 300, 100);
  EXPECT_GT(image::compare_images(image, rendered(model)).psnr, 45);
}

TEST_P(UniformFit, QuadraticsAreReproducedWhereTheSpaceHoldsThem) {
  if (GetParam() == 1) return;
  const image::Image image = picture(60, 40, 3, quadratic);
  for (const bool smooth_corners : {false, true}) {
    // The ridge is all that stands between the fit and the exact answer.
    const auto model = fit_uniform(image, {.control_points = 120,
                                           .degree = GetParam(),
                                           .colour = {.ridge = 1e-10, .smooth_corners = smooth_corners}});
    const image::Image out = rendered(model);
    for (std::size_t i = 0; i < out.samples.size(); ++i) {
      ASSERT_NEAR(out.samples[i], image.samples[i], 1e-3) << i << " smooth corners " << smooth_corners;
    }
  }
}

TEST_P(UniformFit, PicturesOfAnySizeAndChannelsAreFitted) {
  for (const int channels : {1, 2, 3, 4}) {
    for (const auto& [w, h] : {std::pair{1, 1}, {1, 9}, {9, 1}, {2, 2}, {3, 3}, {7, 50}}) {
      const image::Image image = picture(w, h, channels, smooth);
      const auto model = fit_uniform(image, {.degree = GetParam()});
      ASSERT_EQ(model.channels, channels);
      for (const float v : rendered(model).samples) ASSERT_TRUE(std::isfinite(v));
    }
  }
}

TEST_P(UniformFit, MoreControlPointsThanPixelsAreHarmless) {
  const image::Image image = picture(20, 16, 3, smooth);
  const auto model = fit_uniform(image, {.control_points = 1000, .degree = GetParam()});
  EXPECT_GT(image::compare_images(image, rendered(model)).psnr, 50);
  for (const double c : model.colour) EXPECT_LT(std::abs(c), 1000) << "control colours must not run away";
}

TEST_P(UniformFit, TheResultDoesNotDependOnTheNumberOfThreads) {
  const image::Image image = picture(80, 60, 3, smooth);
  std::vector<double> colours[2];
  for (int i = 0; i < 2; ++i) {
    const ThreadCap cap(i == 0 ? 1 : 4);
    colours[i] = fit_uniform(image, {.degree = GetParam()}).colour;
  }
  EXPECT_EQ(colours[0], colours[1]);
}

TEST(ColourFit, LargePicturesAreFittedInBands) {
  const image::Image image = picture(2100, 2100, 1, smooth);  // more than one band of 2^22 pixels
  const auto model = fit_uniform(image, {.control_points = 200, .degree = 1});
  EXPECT_GT(image::compare_images(image, rendered(model)).psnr, 35);
}

TEST(ColourFit, RefusesAMeshOfAnotherSize) {
  const auto space = std::make_shared<const spline::SplineSpace>(uniform_mesh(10, 10, 4, 1), 2);
  const image::Image wide = image::make_image(11, 10, 3);
  EXPECT_THROW(fit_colours(spline::Basis(space), {.image = &wide}), Error);
}

}  // namespace
}  // namespace knotreel::fit
