// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "clips.h"
#include "support/pictures.h"
#include "support/temp_dir.h"

namespace knotreel::video {
namespace {

using test::largest_difference;
using test::TempDir;

/// Few flat colours; with alpha, discs before nothing.
ClipSpec flat_shapes(int channels) {
  ClipSpec clip = moving_pattern(64, 48, channels, 5);
  for (std::size_t t = 0; t < 5; ++t) {
    image::Image& picture = clip.images[t];
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x) {
        const bool seen = std::hypot(x - 15 - 8 * double(t), y - 24) < 14;
        const float colour[4] = {seen ? 200.0F : 0, seen ? float(2 * y) : 0, seen ? 40.0F : 0,
                                 seen ? 255.0F : 0};
        for (int c = 0; c < channels; ++c) picture.at(x, y, c) = colour[c];
      }
    }
  }
  return clip;
}

TEST(Gif, KeepsColoursAndWhatIsTransparent) {
  const TempDir dir;
  const ClipSpec clip = flat_shapes(4);
  write_clip(dir / "a.gif", clip);
  const WholeClip back = read_clip(dir / "a.gif");
  ASSERT_EQ(back.info.channels, 4);
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

TEST(Gif, OpaqueOnesHaveNoAlpha) {
  const TempDir dir;
  for (const int channels : {1, 3}) {
    const ClipSpec clip = flat_shapes(channels);
    write_clip(dir / "a.gif", clip);
    const WholeClip back = read_clip(dir / "a.gif");
    EXPECT_EQ(back.info.pixel_format, "bgr0");
    ASSERT_EQ(back.info.channels, 3);
    ASSERT_EQ(back.frames.size(), 5u);
    for (std::size_t t = 0; t < 5; ++t)
      EXPECT_EQ(largest_difference(back.frames[t].image, image::widen_channels(clip.images[t], 3)), 0) << t;
  }
}

TEST(Gif, OnesThatGetTransparentHaveAlpha) {
  const TempDir dir;
  ClipSpec clip = flat_shapes(4);
  for (std::size_t i = 3; i < clip.images[0].samples.size(); i += 4) clip.images[0].samples[i] = 255;
  write_clip(dir / "a.gif", clip);
  const WholeClip back = read_clip(dir / "a.gif");
  ASSERT_EQ(back.info.channels, 4);
  EXPECT_EQ(back.frames.at(0).image.samples[3], 255);
  EXPECT_EQ(back.frames.at(1).image.samples[3], 0);
}

TEST(Gif, OnesThatAreCutShortHaveAlpha) {  // what is not there may clear what is
  const TempDir dir;
  write_clip(dir / "a.gif", flat_shapes(3));
  const std::string bytes = test::read_text(dir / "a.gif");
  test::write_text(dir / "b.gif", bytes.substr(0, bytes.size() - 1));
  EXPECT_EQ(read_clip(dir / "b.gif").info.channels, 4);
}

}  // namespace
}  // namespace knotreel::video
