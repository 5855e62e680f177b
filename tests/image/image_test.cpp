// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/image/image.h"

#include <gtest/gtest.h>

#include "knotreel/base/error.h"
#include "knotreel/image/format.h"
#include "knotreel/image/metrics.h"
#include "knotreel/image/resize.h"

namespace knotreel::image {
namespace {

TEST(Image, SamplesAreRowMajorAndInterleaved) {
  Image image = make_image(3, 2, 3);
  image.at(2, 1, 1) = 7;
  EXPECT_EQ(image.samples[1 * 9 + 2 * 3 + 1], 7);
  EXPECT_EQ(image.row(1)[7], 7);
}

TEST(Image, ImpossibleShapesAreRefused) {
  EXPECT_THROW(make_image(0, 1, 1), Error);
  EXPECT_THROW(make_image(1, -1, 1), Error);
  EXPECT_THROW(make_image(1, 1, 5), Error);
  EXPECT_THROW(make_image(1 << 20, 1 << 20, 1), Error);
}

TEST(Image, WideningRepeatsGreyAndMakesOpaque) {
  const Image grey{1, 1, 1, {9}};
  EXPECT_EQ(widen_channels(grey, 4).samples, (std::vector<float>{9, 9, 9, 255}));
  const Image grey_alpha{1, 1, 2, {9, 100}};
  EXPECT_EQ(widen_channels(grey_alpha, 4).samples, (std::vector<float>{9, 9, 9, 100}));
  EXPECT_THROW(widen_channels(grey_alpha, 3), Error);
  EXPECT_THROW(widen_channels(Image{1, 1, 3, {1, 2, 3}}, 1), Error);
}

TEST(Format, ExtensionsAreKnownInAnyCase) {
  EXPECT_EQ(format_of_extension("PNG"), ImageFormat::kPng);
  EXPECT_EQ(format_of_extension("jpeg"), ImageFormat::kJpeg);
  EXPECT_EQ(format_of_extension("ppm"), ImageFormat::kPnm);
  EXPECT_EQ(format_of_extension("tcb"), std::nullopt);
  EXPECT_EQ(format_of_extension(""), std::nullopt);
}

TEST(Image, ThoseWithoutTheSamplesThatTheyTellOfAreRefused) {
  const Image short_of_samples{4, 3, 3, std::vector<float>(30)};
  const Image whole = make_image(4, 3, 3);
  EXPECT_THROW(widen_channels(short_of_samples, 4), Error);
  EXPECT_THROW(compare_images(short_of_samples, whole), Error);
  EXPECT_THROW(compare_images(whole, short_of_samples), Error);
  EXPECT_THROW(resize(short_of_samples, 2, 2), Error);
  EXPECT_THROW(check_image(Image{}), Error);
  EXPECT_NO_THROW(check_image(whole));
}

}  // namespace
}  // namespace knotreel::image
