// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/metrics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "support/pictures.h"

namespace knotreel::image {
namespace {

using test::random_picture;

/// SSIM as the paper writes it: one window after the other, two-dimensional weights, central moments.
double slow_ssim(const Image& a, const Image& b) {
  const auto odd = [](int n) { return std::min(11, n % 2 == 0 ? n - 1 : n); };
  const int w = odd(a.width);
  const int h = odd(a.height);
  const auto luma = [](const Image& image, int x, int y) {
    if (image.colour_channels() == 1) return double{image.at(x, y, 0)};
    return 0.299 * double{image.at(x, y, 0)} + 0.587 * double{image.at(x, y, 1)} +
           0.114 * double{image.at(x, y, 2)};
  };
  double total = 0;
  int windows = 0;
  for (int top = 0; top + h <= a.height; ++top) {
    for (int left = 0; left + w <= a.width; ++left, ++windows) {
      const auto sum = [&](auto value) {
        double weights = 0;
        double result = 0;
        for (int j = 0; j < h; ++j) {
          for (int i = 0; i < w; ++i) {
            const double dx = i - (w - 1) / 2.0;
            const double dy = j - (h - 1) / 2.0;
            const double weight = std::exp(-(dx * dx + dy * dy) / (2 * 1.5 * 1.5));
            weights += weight;
            result += weight * value(luma(a, left + i, top + j), luma(b, left + i, top + j));
          }
        }
        return result / weights;
      };
      const double mean_a = sum([](double p, double) { return p; });
      const double mean_b = sum([](double, double q) { return q; });
      const double var_a = sum([&](double p, double) { return (p - mean_a) * (p - mean_a); });
      const double var_b = sum([&](double, double q) { return (q - mean_b) * (q - mean_b); });
      const double cov = sum([&](double p, double q) { return (p - mean_a) * (q - mean_b); });
      const double c1 = 6.5025;
      const double c2 = 58.5225;
      total += (2 * mean_a * mean_b + c1) * (2 * cov + c2) /
               ((mean_a * mean_a + mean_b * mean_b + c1) * (var_a + var_b + c2));
    }
  }
  return total / windows;
}

TEST(Metrics, EqualPicturesAreAtNoDistance) {
  const Image image = random_picture(20, 15, 3, 1);
  const ImageMetrics metrics = compare_images(image, image);
  EXPECT_EQ(metrics.mec, 0);
  EXPECT_EQ(metrics.rmse, 0);
  EXPECT_TRUE(std::isinf(metrics.psnr) && metrics.psnr > 0);
  EXPECT_NEAR(metrics.ssim, 1, 1e-12);
}

TEST(Metrics, AConstantShiftHasTheValuesOfTheFormulas) {
  Image a = make_image(16, 16, 3);
  Image b = a;
  for (std::size_t i = 0; i < b.samples.size(); ++i)
    b.samples[i] = i % 3 == 0 ? 3.0F : i % 3 == 1 ? 4.0F : 12.0F;
  const ImageMetrics metrics = compare_images(a, b);
  EXPECT_NEAR(metrics.mec, 13, 1e-12);  // 3, 4, 12, 13
  EXPECT_NEAR(metrics.rmse, std::sqrt(169.0 / 3) / 255, 1e-12);
  EXPECT_NEAR(metrics.psnr, 10 * std::log10(255 * 255 / (169.0 / 3)), 1e-12);
}

TEST(Metrics, PsnrIsTakenOnEightBits) {
  const Image a{1, 1, 1, {100.0F}};
  EXPECT_TRUE(std::isinf(compare_images(a, Image{1, 1, 1, {100.4F}}).psnr));
  EXPECT_NEAR(compare_images(a, Image{1, 1, 1, {100.6F}}).psnr, 20 * std::log10(255), 1e-12);
  const Image white{1, 1, 1, {255.0F}};
  EXPECT_TRUE(std::isinf(compare_images(white, Image{1, 1, 1, {999.0F}}).psnr))
      << "values beyond the range are clamped";
}

TEST(Metrics, AlphaIsSeenOnBlackAndOnWhite) {
  const Image nothing{1, 1, 4, {0, 0, 0, 0}};
  const Image black{1, 1, 4, {0, 0, 0, 255}};
  const ImageMetrics metrics = compare_images(nothing, black);  // as far apart as can be, on white alone
  EXPECT_NEAR(metrics.mec, 255 * std::sqrt(3) / 2, 1e-9);
  EXPECT_NEAR(metrics.rmse, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(metrics.psnr, 10 * std::log10(2), 1e-9);
}

TEST(Metrics, ColoursThatAlphaHidesDoNotCount) {
  Image a = random_picture(30, 20, 4, 1);
  Image b = random_picture(30, 20, 4, 2);
  for (std::size_t i = 3; i < a.samples.size(); i += 4) a.samples[i] = b.samples[i] = 0;
  const ImageMetrics metrics = compare_images(a, b);
  EXPECT_EQ(metrics.mec, 0);
  EXPECT_TRUE(std::isinf(metrics.psnr));
  EXPECT_NEAR(metrics.ssim, 1, 1e-12);
}

TEST(Metrics, WithAlphaAreMeansOfBothGrounds) {
  const Image a = random_picture(30, 20, 4, 1);
  const Image b = random_picture(30, 20, 4, 2);
  const auto on = [](const Image& picture, float ground) {
    Image seen = make_image(picture.width, picture.height, 3);
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x) {
        const float alpha = picture.at(x, y, 3) / 255;
        for (int c = 0; c < 3; ++c) seen.at(x, y, c) = alpha * picture.at(x, y, c) + (1 - alpha) * ground;
      }
    }
    return seen;
  };
  const ImageMetrics both = compare_images(a, b);
  const ImageMetrics black = compare_images(on(a, 0), on(b, 0));
  const ImageMetrics white = compare_images(on(a, 255), on(b, 255));
  EXPECT_NEAR(both.mec, (black.mec + white.mec) / 2, 1e-4);
  EXPECT_NEAR(both.ssim, (black.ssim + white.ssim) / 2, 1e-6);
  EXPECT_NEAR(std::pow(both.rmse, 2), (std::pow(black.rmse, 2) + std::pow(white.rmse, 2)) / 2, 1e-6);
  EXPECT_NEAR(std::pow(10, -both.psnr / 10),
              (std::pow(10, -black.psnr / 10) + std::pow(10, -white.psnr / 10)) / 2, 1e-6);
}

TEST(Metrics, OpaquePicturesDoNotNeedTheirAlpha) {
  const Image a = random_picture(30, 20, 3, 1);
  const Image b = random_picture(30, 20, 3, 2);
  const ImageMetrics without = compare_images(a, b);
  const ImageMetrics with = compare_images(widen_channels(a, 4), b);
  EXPECT_NEAR(with.mec, without.mec, 1e-9);
  EXPECT_NEAR(with.psnr, without.psnr, 1e-9);
  EXPECT_NEAR(with.ssim, without.ssim, 1e-12);
}

TEST(Metrics, AreSymmetric) {
  const Image a = random_picture(30, 17, 3, 1);
  const Image b = random_picture(30, 17, 3, 2);
  const ImageMetrics ab = compare_images(a, b);
  const ImageMetrics ba = compare_images(b, a);
  EXPECT_EQ(ab.mec, ba.mec);
  EXPECT_EQ(ab.rmse, ba.rmse);
  EXPECT_EQ(ab.psnr, ba.psnr);
  EXPECT_NEAR(ab.ssim, ba.ssim, 1e-14);
}

TEST(Metrics, GreyIsComparedWithColourAsRepeated) {
  const Image grey = random_picture(12, 12, 1, 1);
  const Image colour = random_picture(12, 12, 3, 2);
  EXPECT_EQ(compare_images(grey, colour).mec, compare_images(widen_channels(grey, 3), colour).mec);
}

TEST(Metrics, SsimAgreesWithTheSlowReference) {
  for (const auto& [width, height] : {std::pair{11, 11}, {24, 19}, {40, 12}, {5, 30}, {1, 1}, {8, 2}}) {
    for (const int channels : {1, 3}) {
      const Image a = random_picture(width, height, channels, 3);
      Image b = random_picture(width, height, channels, 4);
      for (std::size_t i = 0; i < b.samples.size(); ++i)
        b.samples[i] = 0.7F * a.samples[i] + 0.3F * b.samples[i];
      EXPECT_NEAR(compare_images(a, b).ssim, slow_ssim(a, b), 1e-9)
          << width << "x" << height << ", " << channels;
    }
  }
}

TEST(Metrics, TheOthersAreTheSameWithoutSsim) {
  const Image a = random_picture(40, 30, 3, 1), b = random_picture(40, 30, 3, 2);
  const ImageMetrics all = compare_images(a, b), some = compare_images(a, b, Figures::kWithoutSsim);
  EXPECT_NE(all.ssim, 0);
  EXPECT_EQ(some.ssim, 0);
  EXPECT_EQ(some.mec, all.mec);
  EXPECT_EQ(some.rmse, all.rmse);
  EXPECT_EQ(some.psnr, all.psnr);
}

TEST(Metrics, ThreadsDoNotShow) {
  const Image a = random_picture(200, 150, 3, 1);
  const Image b = random_picture(200, 150, 3, 2);
  const ImageMetrics many = compare_images(a, b);
  const ThreadCap cap(1);
  const ImageMetrics one = compare_images(a, b);
  EXPECT_EQ(many.mec, one.mec);
  EXPECT_EQ(many.rmse, one.rmse);
  EXPECT_EQ(many.ssim, one.ssim);
}

TEST(Metrics, DifferentSizesAreRefused) {
  EXPECT_THROW(compare_images(make_image(2, 3, 1), make_image(3, 2, 1)), Error);
  EXPECT_THROW(compare_images(Image{}, Image{}), Error);
}

}  // namespace
}  // namespace knotreel::image
