// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "knotreel/base/parallel.h"
#include "vectorize/scenes.h"

namespace knotreel::vectorize {
namespace {

TEST(VectorizeLaws, APictureOfAKnownDocumentIsRecovered) {
  // A document with features, from a picture; its own picture is then as good as exact for the method.
  const image::Image source = still_life(160, 120);
  Options coarse;
  coarse.max_control_points = 260;
  const document::FrameModel known = vectorize_picture(source, coarse).model;
  const image::Image picture = rendered(known);
  Options options = preset_options(Preset::kFine);
  options.max_control_points = 1200;
  options.mec = 0;
  EXPECT_GE(psnr(picture, vectorize_picture(picture, options).model), 45);
}

TEST(VectorizeLaws, ASecondTimeLosesLittle) {
  const image::Image source = still_life(160, 120);
  Options options;
  options.max_control_points = 600;
  const document::FrameModel first = vectorize_picture(source, options).model;
  const document::FrameModel second = vectorize_picture(rendered(first), options).model;
  const double once = psnr(source, first);
  const double twice = psnr(source, second);
  RecordProperty("once", std::to_string(once));
  RecordProperty("twice", std::to_string(twice));
  EXPECT_GT(twice, once - 5);
}

enum class Turn { kMirror, kFlip, kTranspose };

image::Image turned(const image::Image& image, Turn turn) {
  const bool swap = turn == Turn::kTranspose;
  image::Image out =
      image::make_image(swap ? image.height : image.width, swap ? image.width : image.height, image.channels);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < image.channels; ++c) {
        const int u = turn == Turn::kMirror ? image.width - 1 - x : swap ? y : x;
        const int v = turn == Turn::kFlip ? image.height - 1 - y : swap ? x : y;
        out.at(u, v, c) = image.at(x, y, c);
      }
    }
  }
  return out;
}

TEST(VectorizeLaws, MirroredAndTurnedPicturesGiveTheSameWithinABound) {
  // Ties are broken by position and knots inserted in another order, so equality is of quality, and of the
  // picture as far as both are right.
  const image::Image picture = still_life(140, 110);
  Options options;
  options.max_control_points = 500;
  const document::FrameModel plain = vectorize_picture(picture, options).model;
  const double quality = psnr(picture, plain);
  for (const Turn turn : {Turn::kMirror, Turn::kFlip, Turn::kTranspose}) {
    const image::Image other = turned(picture, turn);
    const document::FrameModel model = vectorize_picture(other, options).model;
    EXPECT_NEAR(psnr(other, model), quality, 3) << static_cast<int>(turn);
    EXPECT_GT(image::compare_images(turned(rendered(plain), turn), rendered(model)).psnr, quality - 6);
    const auto a = static_cast<double>(plain.space->function_count());
    EXPECT_NEAR(static_cast<double>(model.space->function_count()), a, 0.1 * a);
  }
}

TEST(VectorizeLaws, TheSameBitsForAnyNumberOfThreads) {
  const image::Image picture = still_life(160, 120, 4);
  const auto run = [&](int threads) {
    const ThreadCap cap(threads);
    return vectorize_picture(picture).model;
  };
  const document::FrameModel one = run(1);
  for (const int threads : {2, 3}) {
    const document::FrameModel many = run(threads);
    EXPECT_EQ(one.colour, many.colour);
    EXPECT_EQ(one.displacement, many.displacement);
    ASSERT_EQ(one.space->mesh().knots.size(), many.space->mesh().knots.size());
    for (std::size_t k = 0; k < one.space->mesh().knots.size(); ++k) {
      EXPECT_EQ(one.space->mesh().knots[k].position, many.space->mesh().knots[k].position);
    }
  }
}

}  // namespace
}  // namespace knotreel::vectorize
