// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/base/vec2.h"
#include "knotreel/image/image.h"

/// Knot meshes for pictures: where to put knots and how to join them (paper sec. 6, 8).
namespace knotreel::knots {

/// Sums over the pixels of a region: of weight w, of w times x, y and their products, and of w times the
/// colour c, x c and y c per channel; squares holds the sum of w |c|^2 over all channels. Positions are pixel
/// centres.
struct Moments {
  double w = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, squares = 0;
  std::array<double, 4> c{}, xc{}, yc{};

  Moments operator+(const Moments& m) const;
};

/// The best linear approximation of the picture on a region, in the least-squares sense.
struct LinearFit {
  double error = 0;               ///< sum of w times the squared colour error over pixels and channels
  double weight = 0;              ///< sum of w
  Vec2 centre;                    ///< weighted mean of the positions
  std::array<double, 4> value{};  ///< colour at the centre
  std::array<Vec2, 4> gradient{};

  /// The colour that it has at a point, in one channel.
  double at(Vec2 u, std::size_t channel) const { return value[channel] + dot(gradient[channel], u - centre); }
};

/// A picture over the parametric domain with a weight per pixel, ready for sums over triangles: prefix sums
/// along its rows make the cost of a sum proportional to the height of the triangle, not to its area.
/// Thread safe but for change_to(). Memory: up to 4 + 2 * channels doubles per pixel besides
/// the picture; 8 for three channels with weights of 1.
class Target {
 public:
  /// The sums are the same, bit for bit.
  enum class Storage : std::uint8_t {
    kFast,
    kCompact,  ///< a quarter of the memory besides the picture, for up to half as much time again
  };

  /// @param weights one per pixel, 0 or more; empty: all 1.
  /// @throws Error{kInvalidArgument} if the sizes disagree.
  Target(image::Image image, std::vector<float> weights, Storage storage = Storage::kFast);

  /// Makes it the target of another picture with the same weights: as one that is made anew, but rows of
  /// pixels that are equal cost next to nothing. @throws Error{kInvalidArgument} if sizes or channels differ.
  void change_to(const image::Image& image);

  const image::Image& image() const { return image_; }
  int channels() const { return image_.channels; }
  double weight(int x, int y) const {
    return weights_.empty() ? 1.0 : static_cast<double>(weights_[pixel(x, y)]);
  }

  /// Sums over the pixels whose centres lie in a positively oriented triangle. A centre on an edge belongs to
  /// exactly one of the two triangles there.
  Moments moments(const std::array<Vec2, 3>& triangle) const;

  /// The same, summed up to the best linear approximation (paper Eq. 7).
  LinearFit fit(const std::array<Vec2, 3>& triangle) const;
  /// The same of sums, such as those over several triangles.
  LinearFit fit(const Moments& moments) const;
  /// Only its error.
  double error(const std::array<Vec2, 3>& triangle) const;

  /// The picture at a point, interpolated between pixels. @param channels of the picture: quicker where the
  /// compiler knows them.
  std::array<double, 4> colour(Vec2 u, std::size_t channels) const;
  /// Asks for the memory that colour() will read.
  void prefetch_colour(Vec2 u, std::size_t channels) const;

  /// Squared error of a linear approximation at a point where the picture has this colour. @param channels of
  /// the picture: quicker where the compiler knows them.
  static double squared_error(const LinearFit& fit, Vec2 u, const std::array<double, 4>& colour,
                              std::size_t channels) {
    double sum = 0;
    for (std::size_t c = 0; c < channels; ++c) {
      const double d = colour[c] - fit.at(u, c);
      sum += d * d;
    }
    return sum;
  }

  /// Calls visit(x, y) for all pixels whose centres lie in the triangle, as in moments().
  template <class Visit>
  void for_pixels(const std::array<Vec2, 3>& triangle, Visit&& visit) const;

 private:
  struct Cell;
  Cell cell_at(Vec2 u, std::size_t channels) const;
  void add_up_row(std::size_t y);
  std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(image_.width) + static_cast<std::size_t>(x);
  }

  image::Image image_;
  std::vector<float> weights_;
  bool compact_;
  /// Numbers that are in one line of the cache if there are no more of them per pixel.
  struct alignas(64) Line : std::array<double, 8> {};
  std::unique_ptr<Line[]> prefix_;  ///< not a vector, which would be zeroed first
};

/// Rows of pixels of a triangle: for row y, columns [begin(y), end(y)).
class TriangleRows {
 public:
  /// @param triangle  in any order. @param width, height of the picture, outside of which there are no
  /// pixels.
  TriangleRows(const std::array<Vec2, 3>& triangle, int width, int height);

  int first() const { return first_; }
  int last() const { return last_; }  ///< one past
  /// Columns of a row in [first(), last()).
  [[gnu::always_inline]] void columns(int y, int& begin, int& end) const {
    const double centre = y + 0.5;
    const double across = cut(long_, centre);
    const double other = cut(centre < upper_.y_end ? upper_ : lower_, centre);
    begin = std::clamp(first_centre(long_is_left_ ? across : other), 0, width_);
    end = std::clamp(first_centre(long_is_left_ ? other : across), begin, width_);
  }

  /// The first row or column whose pixel centres are at v or beyond.
  [[gnu::always_inline]] static int first_centre(double v) { return static_cast<int>(std::ceil(v - 0.5)); }

 private:
  struct Line {
    double x, y, slope, y_end;
  };
  double cut(const Line& line, double y) const { return line.x + (y - line.y) * line.slope; }

  int width_;
  int first_ = 0;
  int last_ = 0;
  Line long_, upper_, lower_;
  bool long_is_left_ = true;
};

/// Four pixels around a point: the upper left one, and where the point lies between them.
struct Target::Cell {
  const float* p;
  double fx;
  double fy;
};

[[gnu::always_inline]] inline Target::Cell Target::cell_at(Vec2 u, std::size_t channels) const {
  const double px = std::clamp(u.x - 0.5, 0.0, static_cast<double>(image_.width - 1));
  const double py = std::clamp(u.y - 0.5, 0.0, static_cast<double>(image_.height - 1));
  const int x = std::min(static_cast<int>(px), std::max(0, image_.width - 2));
  const int y = std::min(static_cast<int>(py), std::max(0, image_.height - 2));
  return {image_.samples.data() + pixel(x, y) * channels, px - x, py - y};
}

[[gnu::always_inline]] inline std::array<double, 4> Target::colour(Vec2 u, std::size_t channels) const {
  const auto [p, fx, fy] = cell_at(u, channels);
  const std::size_t right = image_.width > 1 ? channels : 0;
  const std::size_t below = image_.height > 1 ? image_.row_size() : 0;
  std::array<double, 4> result{};
  for (std::size_t c = 0; c < channels; ++c) {
    const double top = (1 - fx) * static_cast<double>(p[c]) + fx * static_cast<double>(p[right + c]);
    const double low =
        (1 - fx) * static_cast<double>(p[below + c]) + fx * static_cast<double>(p[below + right + c]);
    result[c] = (1 - fy) * top + fy * low;
  }
  return result;
}

[[gnu::always_inline]] inline void Target::prefetch_colour(Vec2 u, std::size_t channels) const {
#if defined(__GNUC__)
  const float* const p = cell_at(u, channels).p;
  const std::size_t below = image_.height > 1 ? image_.row_size() : 0;
  __builtin_prefetch(p);
  __builtin_prefetch(p + 2 * channels - 1);
  __builtin_prefetch(p + below);
  __builtin_prefetch(p + below + 2 * channels - 1);
#else
  (void)u;
  (void)channels;
#endif
}

template <class Visit>
void Target::for_pixels(const std::array<Vec2, 3>& triangle, Visit&& visit) const {
  const TriangleRows rows(triangle, image_.width, image_.height);
  for (int y = rows.first(); y < rows.last(); ++y) {
    int begin = 0;
    int end = 0;
    rows.columns(y, begin, end);
    for (int x = begin; x < end; ++x) visit(x, y);
  }
}

}  // namespace knotreel::knots
