// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/find_curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <random>

#include "vectorize/fine_grid.h"

namespace knotreel::vectorize {
namespace {

constexpr std::uint64_t kFindCurvesSeed = 20261130;
constexpr int kDrawingWidth = 240;
constexpr int kDrawingHeight = 180;

/// An ellipse or a box in one colour, antialiased by 4 x 4 samples per pixel.
struct Shape {
  bool is_round;
  double x, y, width, height;  ///< from its middle
  float colour[3];
};

class RandomDrawing {
 public:
  explicit RandomDrawing(std::uint64_t seed) : random_(seed) {
    for (int i = 0; i < 9; ++i) shapes_.push_back(any_shape());
  }

  /// Moves a small one about, or changes more of it, now and then all.
  void change() {
    switch (random_() % 8) {
      case 0:
        shapes_[random_() % shapes_.size()] = any_shape();
        break;
      case 1:
        blot_ = any_shape();
        break;
      case 2:
        blot_.reset();
        break;
      case 3:
        if (random_() % 3 == 0)
          for (Shape& shape : shapes_) shape = any_shape();
        break;
      case 4:  // all move
        for (Shape& shape : shapes_) shape.y += 3;
        break;
      case 5:
        shapes_[0].colour[0] += shapes_[0].colour[0] < 200 ? 2.0F : -2.0F;
        break;
      default:
        pointer_ = {true, unit() * kDrawingWidth, unit() * kDrawingHeight, 4, 4, {10, 20, 30}};
    }
  }

  image::Image picture() const {
    image::Image image = image::make_image(kDrawingWidth, kDrawingHeight, 3);
    std::fill(image.samples.begin(), image.samples.end(), 235.0F);
    add_grain(image);
    for (const Shape& shape : shapes_) draw(shape, image);
    if (blot_) draw(*blot_, image);
    draw(pointer_, image);
    return image;
  }

 private:
  /// Too faint for edges, but where the ground is flat nothing shows that a window is too small.
  static void add_grain(image::Image& image) {
    std::mt19937 random(1);
    for (float& sample : image.samples) sample += static_cast<float>(random() % 256) / 1024;
  }

  double unit() { return static_cast<double>(random_() % 4096) / 4096; }

  Shape any_shape() {
    Shape shape{random_() % 2 == 0, unit() * kDrawingWidth, unit() * kDrawingHeight, 3 + 18 * unit(), 0, {}};
    shape.height = random_() % 2 == 0 ? shape.width : 1 + 2 * unit();  // lines, too
    for (float& c : shape.colour) c = static_cast<float>(random_() % 256);
    return shape;
  }

  static void draw(const Shape& shape, image::Image& image) {
    const auto is_inside = [&](double x, double y) {
      const double u = std::abs(x - shape.x) / shape.width, v = std::abs(y - shape.y) / shape.height;
      return (shape.is_round ? std::hypot(u, v) : std::max(u, v)) < 1;
    };
    for (int y = 0; y < image.height; ++y) {
      for (int x = 0; x < image.width; ++x) {
        int inside = 0;
        for (int s = 0; s < 16; ++s) inside += is_inside(x + (s % 4 + 0.5) / 4, y + (s / 4 + 0.5) / 4);
        const float share = static_cast<float>(inside) / 16;
        for (int c = 0; c < 3; ++c)
          image.at(x, y, c) = (1 - share) * image.at(x, y, c) + share * shape.colour[c];
      }
    }
  }

  std::mt19937_64 random_;
  std::vector<Shape> shapes_;
  std::optional<Shape> blot_;
  Shape pointer_{true, 50, 50, 4, 4, {10, 20, 30}};
};

void expect_same(const features::FeatureChains& a, const features::FeatureChains& b) {
  ASSERT_EQ(a.chains.size(), b.chains.size());
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.height, b.height);
  EXPECT_EQ(a.node_count, b.node_count);
  for (std::size_t i = 0; i < a.chains.size(); ++i) {
    const features::Chain& p = a.chains[i];
    const features::Chain& q = b.chains[i];
    ASSERT_EQ(p.points.size(), q.points.size()) << i;
    EXPECT_EQ(p.closed, q.closed);
    EXPECT_EQ(p.first_node, q.first_node);
    EXPECT_EQ(p.last_node, q.last_node);
    EXPECT_EQ(p.first_on_border, q.first_on_border);
    EXPECT_EQ(p.last_on_border, q.last_on_border);
    EXPECT_EQ(p.stepped, q.stepped);
    for (std::size_t k = 0; k < p.points.size(); ++k) {
      const features::ChainPoint& u = p.points[k];
      const features::ChainPoint& v = q.points[k];
      ASSERT_TRUE(u.x == v.x && u.y == v.y && u.position == v.position && u.beyond == v.beyond &&
                  u.corner == v.corner && u.rounded == v.rounded && u.preferred == v.preferred)
          << "chain " << i << ", point " << k;
    }
  }
}

/// The same in grey, or with alpha that is less where there is more red.
image::Image with_channels(const image::Image& image, int channels) {
  image::Image result = image::make_image(image.width, image.height, channels);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (int c = 0; c < std::min(3, channels); ++c) result.at(x, y, c) = image.at(x, y, c);
      if (channels == 4) result.at(x, y, 3) = 255 - image.at(x, y, 0) / 2;
    }
  }
  return result;
}

class FindCurves : public ::testing::TestWithParam<int> {
 protected:
  /// Curves of the picture with what is known, which it becomes, and without.
  void compare(const image::Image& picture) {
    const Options options = GetParam() == 2 ? on_fine_grid(drawn_) : drawn_;
    features::KnownCorners nobody;
    const KnownCurves alone = find_curves(picture, GetParam(), options, nobody, nullptr);
    known_ = find_curves(picture, GetParam(), options, corners_, known_ ? &*known_ : nullptr);
    expect_same(alone.curves.detected, known_->curves.detected);
    expect_same(alone.curves.faired, known_->curves.faired);
    expect_same(alone.winding, known_->winding);
    for (int row = 0; row < alone.edges.rows(); ++row)
      for (int column = 0; column < alone.edges.columns(); ++column)
        ASSERT_EQ(alone.edges.at(column, row), known_->edges.at(column, row)) << column << ' ' << row;
    chains_ += alone.curves.faired.chains.size();
  }

  Options drawn_ = drawn_video_options(group_preset_options(Preset::kBalanced));
  features::KnownCorners corners_;
  std::optional<KnownCurves> known_;
  std::size_t chains_ = 0;
};

TEST_P(FindCurves, WhatIsKnownDoesNotShow) {
  for (std::uint64_t seed = kFindCurvesSeed; seed < kFindCurvesSeed + 2; ++seed) {
    RandomDrawing drawing(seed);
    for (int step = 0; step < 10 && !HasFailure(); ++step) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", step " + std::to_string(step));
      compare(drawing.picture());
      drawing.change();
    }
  }
  EXPECT_GT(chains_, 50U);
}

TEST_P(FindCurves, WhatIsKnownDoesNotShowWithOtherChannelsAndOptions) {
  for (std::uint64_t seed = kFindCurvesSeed; seed < kFindCurvesSeed + 2; ++seed) {
    RandomDrawing drawing(seed);
    for (int step = 0; step < 6 && !HasFailure(); ++step) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", step " + std::to_string(step));
      // As long as these stay the same, something is known.
      drawn_.max_turning = step < 3 ? 0.1 : 0;
      drawn_.detect.smoothing = seed % 2 == 0 ? 0 : 2.2;
      compare(with_channels(drawing.picture(), seed % 2 == 0 ? 1 : 4));
      drawing.change();
    }
  }
  EXPECT_GT(chains_, 50U);
}

TEST_P(FindCurves, NothingIsKnownOfAnotherSize) {
  const image::Image large = RandomDrawing(1).picture();
  image::Image small = image::make_image(kDrawingWidth / 2, kDrawingHeight, 3);
  for (int y = 0; y < small.height; ++y)
    std::copy_n(large.row(y).begin(), small.row_size(), small.row(y).begin());
  compare(large);
  compare(small);
  compare(large);
}

INSTANTIATE_TEST_SUITE_P(Grids, FindCurves, ::testing::Values(1, 2));

}  // namespace
}  // namespace knotreel::vectorize
