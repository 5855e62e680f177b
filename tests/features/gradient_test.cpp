// SPDX-License-Identifier: GPL-3.0-or-later
#include "features/gradient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "features/profile.h"
#include "support/pictures.h"

namespace knotreel::features {
namespace {

/// As defined: one two-dimensional sum per pixel, in doubles.
double slow_smooth(const image::Image& image, int x, int y, int c, double sigma) {
  const int radius = int(std::ceil(3 * sigma));
  double sum = 0;
  double weights = 0;
  for (int j = -radius; j <= radius; ++j) {
    for (int i = -radius; i <= radius; ++i) {
      const double weight = sigma > 0 ? std::exp(-0.5 * (i * i + j * j) / (sigma * sigma)) : 1;
      const int px = std::clamp(x + i, 0, image.width - 1);
      const int py = std::clamp(y + j, 0, image.height - 1);
      const bool weighted = image.has_alpha() && c + 1 < image.channels;
      const double alpha = weighted ? double{image.at(px, py, image.channels - 1)} / 255 : 1;
      sum += weight * alpha * double{image.at(px, py, c)};
      weights += weight;
    }
  }
  return sum / weights;
}

TEST(Gradient, AgreesWithTheSlowReference) {
  for (const auto& [columns, rows] : {std::pair{1, 1}, {3, 2}, {17, 70}, {80, 9}}) {
    const int width = columns, height = rows;  // names that lambdas may hold
    for (const int channels : {1, 2, 3, 4}) {
      for (const bool euclidean : {false, true}) {
        DetectOptions options;
        options.smoothing = channels == 2 ? 0 : 0.4 * channels;
        options.euclidean_magnitude = euclidean;
        const image::Image image = test::random_picture(width, height, channels, 7);
        const GradientField field = make_gradient_field(image, options);
        for (int y = 0; y < height; ++y) {
          for (int x = 0; x < width; ++x) {
            double strongest = 0;
            for (int c = 0; c < channels; ++c) {
              const auto s = [&](int px, int py) {
                return slow_smooth(image, std::clamp(px, 0, width - 1), std::clamp(py, 0, height - 1), c,
                                   options.smoothing);
              };
              const double gx = 0.5 * (s(x + 1, y) - s(x - 1, y));
              const double gy = 0.5 * (s(x, y + 1) - s(x, y - 1));
              const double m = euclidean ? std::hypot(gx, gy) : std::max(std::abs(gx), std::abs(gy));
              strongest = std::max(strongest, m);
              if (c == field.channel[field.at(x, y)]) {
                EXPECT_NEAR(field.gradient(x, y).x, gx, 1e-4);
                EXPECT_NEAR(field.gradient(x, y).y, gy, 1e-4);
                EXPECT_NEAR(double{field.magnitude[field.at(x, y)]}, m, 1e-4);
              }
            }
            EXPECT_NEAR(double{field.magnitude[field.at(x, y)]}, strongest, 1e-4);
          }
        }
      }
    }
  }
}

/// A row of samples, repeated.
image::Image rows_of(const std::vector<float>& row) {
  image::Image image = image::make_image(int(row.size()), 7, 1);
  for (int y = 0; y < 7; ++y) std::copy(row.begin(), row.end(), image.row(y).begin());
  return image;
}

TEST(Profile, AntialiasedStepsAreExact) {
  for (const float share : {0.0F, 0.1F, 0.25F, 0.5F, 0.75F, 0.9F}) {
    const float mixed = 100 + 100 * share;
    const image::Image image = rows_of({100, 100, 100, 100, 100, 100, mixed, 200, 200, 200, 200, 200, 200});
    const GradientField field = make_gradient_field(image, {});
    // Pixel 6 is covered by the bright side from 7 - share on.
    EXPECT_NEAR(refine_position(field, 6, 3).x, 7 - double{share}, 1e-5);
    EXPECT_EQ(refine_position(field, 6, 3).y, 3.5);
  }
}

TEST(Profile, BlurredStepsAreExactOnAndBetweenPixels) {
  for (const double sigma : {0.7, 1.1, 1.5}) {
    for (const double place : {6.5, 7.0}) {
      std::vector<float> row;
      for (int x = 0; x < 14; ++x) row.push_back(float(100 + 50 * std::erf((x + 0.5 - place) / sigma)));
      const image::Image image = rows_of(row);
      const GradientField field = make_gradient_field(image, {});
      EXPECT_NEAR(refine_position(field, 6, 3).x, place, 1e-4) << sigma;
    }
  }
}

TEST(Profile, AFlatRampHasItsEdgeInTheMiddle) {
  const image::Image image = rows_of({10, 10, 10, 10, 10, 40, 70, 100, 130, 130, 130, 130, 130});
  const GradientField field = make_gradient_field(image, {});
  EXPECT_NEAR(refine_position(field, 6, 3).x, 6.5, 1e-9);
  EXPECT_NEAR(transition(field, 6, 3).slope, 30, 1e-9);
  EXPECT_NEAR(transition(field, 6, 3).contrast, 120, 1);
}

TEST(Profile, TheOtherSideOfALineDoesNotCount) {
  const image::Image image = rows_of({10, 10, 10, 10, 10, 200, 10, 10, 10, 10, 10});
  const GradientField field = make_gradient_field(image, {});
  EXPECT_EQ(refine_position(field, 4, 3).x, 5);
  EXPECT_EQ(refine_position(field, 6, 3).x, 6);
}

TEST(Profile, StaysWithinAPixel) {
  const image::Image image = test::random_picture(40, 40, 3, 3);
  const GradientField field = make_gradient_field(image, {});
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 40; ++x) {
      const Vec2 p = refine_position(field, x, y);
      EXPECT_LE(std::abs(p.x - x - 0.5), 1);
      EXPECT_LE(std::abs(p.y - y - 0.5), 1);
    }
  }
}

}  // namespace
}  // namespace knotreel::features
