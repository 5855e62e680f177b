// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/paint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace knotreel::exporting {
namespace {

using Corners = std::array<Vec2, 3>;
using Colours = std::array<Rgb, 3>;

Corners random_triangle(std::mt19937& random) {
  std::uniform_real_distribution<double> at(0, 40);
  Corners x;
  for (Vec2& p : x) p = {at(random) + 100, at(random) + 200};
  return x;
}

Colours painted(const Paint& paint, const Corners& x) {
  Colours colours{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t c = 0; c < 3; ++c) colours[i][c] = paint.at(x[i], c);
  }
  return colours;
}

TEST(Paint, IsFoundAgainFromWhatItPaints) {
  std::mt19937 random(3);
  for (int i = 0; i < 50; ++i) {
    const Paint paint{{120, 80, 40}, {3, -2, 1}, {110, 210}, unit({std::cos(0.7 * i), std::sin(0.7 * i)})};
    Moments sum;
    std::array<Corners, 3> all;
    for (Corners& x : all) {
      x = random_triangle(random);
      sum += moments_of(x, painted(paint, x));
    }
    const PaintFit fit = fit_paint(sum);
    for (const Corners& x : all) {
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(fit.paint.at(x[0], c), paint.at(x[0], c), 0.01);
    }
    EXPECT_NEAR(fit.squared_error, 0, 2e-3 * sum.area);
    EXPECT_NEAR(root_mean_square(paint, sum), 0, 1e-4);
  }
}

/// Integrals do not depend on how a triangle is divided.
TEST(Moments, OfPartsAddUpToThoseOfTheWhole) {
  const Corners x{Vec2{10, 20}, Vec2{50, 25}, Vec2{22, 60}};
  const Colours colour{Rgb{10, 20, 30}, Rgb{200, 100, 0}, Rgb{90, 80, 250}};
  const Vec2 m = 0.5 * (x[0] + x[1]);
  Rgb mixed{};
  for (std::size_t c = 0; c < 3; ++c) mixed[c] = 0.5 * (colour[0][c] + colour[1][c]);
  const Moments whole = moments_of(x, colour);
  Moments parts = moments_of({x[0], m, x[2]}, {colour[0], mixed, colour[2]});
  parts += moments_of({m, x[1], x[2]}, {mixed, colour[1], colour[2]});
  EXPECT_NEAR(parts.area, whole.area, 1e-9 * whole.area);
  EXPECT_NEAR(parts.xy, whole.xy, 1e-9 * whole.xy);
  EXPECT_NEAR(parts.squares, whole.squares, 1e-9 * whole.squares);
  EXPECT_NEAR(parts.x_colour[2].y, whole.x_colour[2].y, 1e-9 * whole.x_colour[2].y);
  EXPECT_NEAR(fit_paint(parts).squared_error, fit_paint(whole).squared_error, 1e-6 * whole.squares);
}

/// Against the integral by sums over many small parts.
TEST(Paint, HasTheRootMeanSquareThatSamplesHave) {
  const Corners x{Vec2{10, 20}, Vec2{30, 25}, Vec2{22, 40}};
  const Colours colour{Rgb{10, 20, 30}, Rgb{200, 100, 0}, Rgb{90, 80, 250}};
  const Paint paint{{100, 70, 90}, {4, -3, 2}, {20, 30}, unit({1, 2})};
  double sum = 0;
  int count = 0;
  constexpr int kParts = 300;
  for (int i = 0; i < kParts; ++i) {
    for (int j = 0; i + j < kParts; ++j) {
      const double a = (i + 1.0 / 3) / kParts;
      const double b = (j + 1.0 / 3) / kParts;
      const Vec2 p = (1 - a - b) * x[0] + a * x[1] + b * x[2];
      for (std::size_t c = 0; c < 3; ++c) {
        const double level = (1 - a - b) * colour[0][c] + a * colour[1][c] + b * colour[2][c];
        sum += (paint.at(p, c) - level) * (paint.at(p, c) - level);
      }
      ++count;
    }
  }
  EXPECT_NEAR(root_mean_square(paint, moments_of(x, colour)), std::sqrt(sum / count), 1);
}

/// No direction and no slope near those found are better.
TEST(Paint, OfLeastSquaresIsTheBest) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> level(0, 255);
  std::normal_distribution<double> change(0, 0.05);
  for (int i = 0; i < 20; ++i) {
    Moments sum;
    for (int k = 0; k < 3; ++k) {
      Colours colours{};
      for (Rgb& rgb : colours) rgb = {level(random), level(random), level(random)};
      sum += moments_of(random_triangle(random), colours);
    }
    const PaintFit fit = fit_paint(sum);
    const double least = root_mean_square(fit.paint, sum);
    EXPECT_NEAR(least * least * sum.area, fit.squared_error, 1e-6 * sum.squares);
    for (int k = 0; k < 20; ++k) {
      Paint other = fit.paint;
      other.direction = turned(other.direction, change(random));
      for (double& s : other.slope) s += change(random);
      for (double& c : other.colour) c += change(random);
      EXPECT_GE(root_mean_square(other, sum), least - 1e-6);
    }
  }
}

}  // namespace
}  // namespace knotreel::exporting
