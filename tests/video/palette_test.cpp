#include "video/palette.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "clips.h"
#include "support/pictures.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::largest_difference;
using test::TempDir;

image::Image from_palette(const PalettePicture& picture, int width, int height) {
  image::Image image = image::make_image(width, height, 4);
  for (std::size_t i = 0; i < picture.indices.size(); ++i) {
    const std::uint32_t argb = picture.colours[picture.indices[i]];
    for (std::size_t c = 0; c < 3; ++c) image.samples[4 * i + c] = float(argb >> (16 - 8 * c) & 0xFF);
    image.samples[4 * i + 3] = float(argb >> 24);
  }
  return image;
}

TEST(Palette, FewColoursAreKeptExactly) {
  for (const int channels : {1, 3}) {
    image::Image picture = image::make_image(20, 10, channels);
    for (std::size_t i = 0; i < picture.samples.size(); ++i) picture.samples[i] = float(i * i % 13 * 20);
    EXPECT_EQ(
        largest_difference(from_palette(in_palette(picture), 20, 10), image::widen_channels(picture, 4)), 0);
  }
}

TEST(Palette, ManyColoursAreNear) {
  image::Image picture = image::make_image(160, 120, 3);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      picture.at(x, y, 0) = 1.5F * float(x);
      picture.at(x, y, 1) = 2 * float(y);
      picture.at(x, y, 2) = 240 - float(x);
    }
  }
  const PalettePicture made = in_palette(picture);
  const image::Image back = from_palette(made, 160, 120);
  double squares = 0;
  for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const double d = double{back.samples[4 * i + c]} - std::round(double{picture.samples[3 * i + c]});
      squares += d * d;
    }
    ASSERT_EQ(back.samples[4 * i + 3], 255);
  }
  // 256 patches of 10 x 7.5 pixels or so: uniform errors of +-7.5, +-7.5 and +-5 levels.
  EXPECT_LT(std::sqrt(squares / double(3 * picture.pixel_count())), 5);
  EXPECT_GT(std::set<std::uint8_t>(made.indices.begin(), made.indices.end()).size(), 240u);
}

TEST(Palette, AlphaIsAllOrNothing) {
  image::Image picture = test::random_8bit_picture(40, 30, 4, 1);
  const image::Image back = from_palette(in_palette(picture), 40, 30);
  for (std::size_t i = 3; i < picture.samples.size(); i += 4)
    ASSERT_EQ(back.samples[i], picture.samples[i] > 127 ? 255 : 0);
  for (std::size_t i = 3; i < picture.samples.size(); i += 4) picture.samples[i] = 0;
  EXPECT_EQ(in_palette(picture).indices, std::vector<std::uint8_t>(1200, 0));
}

TEST(Palette, GifsKeepColoursAndWhatIsTransparent) {
  const TempDir dir;
  ClipSpec clip = moving_pattern(64, 48, 4, 5);
  for (std::size_t t = 0; t < 5; ++t) {
    image::Image& picture = clip.images[t];
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        const bool seen = std::hypot(x - 15 - 8 * double(t), y - 24) < 14;
        const float colour[4] = {seen ? 200.0F : 0, seen ? float(2 * y) : 0, seen ? 40.0F : 0,
                                 seen ? 255.0F : 0};
        for (int c = 0; c < 4; ++c) picture.at(x, y, c) = colour[c];
      }
    }
  }
  write_clip(dir / "a.gif", clip, {});
  const WholeClip back = read_clip(dir / "a.gif");
  ASSERT_EQ(back.frames.size(), 5u);
  for (std::size_t t = 0; t < 5; ++t) {
    const image::Image& image = back.frames[t].image;
    for (std::size_t i = 0; i < image.samples.size(); i += 4) {
      ASSERT_EQ(image.samples[i + 3], clip.images[t].samples[i + 3]) << "frame " << t;
      for (std::size_t c = 0; c < 3 && image.samples[i + 3] > 0; ++c)
        ASSERT_EQ(image.samples[i + c], clip.images[t].samples[i + c]) << "frame " << t;
    }
  }
}

}  // namespace
}  // namespace knotreel::video
