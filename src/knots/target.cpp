#include "knotreel/knots/target.h"

#include <algorithm>
#include <cmath>

#include "base/multiversion.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::knots {

namespace {

// Slots of the prefix sums; after kSquares come c and x c for each channel.
enum Slot : std::size_t { kW, kX, kXX, kSquares, kColour };

/// Draws slopes that few pixels decide towards zero: this many pixels at distance one say that there is none.
constexpr double kSlopeRidge = 1.0;

/// Asks for memory that will be read soon: for places that no hardware could foresee.
template <std::size_t Count>
[[gnu::always_inline]] inline void prefetch(const double* p) {
#if defined(__GNUC__)
  constexpr std::size_t kLine = 64 / sizeof(double);
  for (std::size_t i = 0; i < Count; i += kLine) __builtin_prefetch(p + i);
  __builtin_prefetch(p + Count - 1);
#else
  (void)p;
#endif
}

/// Sums of one triangle with C channels. Where its rows begin and end is found first: their sums are fetched
/// from memory at the same time then, not one after the other.
template <std::size_t C>
[[gnu::always_inline]] inline Moments sum_rows(const TriangleRows& rows, const double* prefix,
                                               std::size_t row_size) {
  constexpr std::size_t kStride = 4 + 2 * C;
  constexpr int kRows = 32;  // at a time
  struct Ends {
    const double* p;
    const double* q;
  };
  std::array<Ends, kRows> ends;
  double sum[kStride] = {};
  double y_sum[kStride] = {};
  double yy = 0;
  for (int first = rows.first(); first < rows.last(); first += kRows) {
    const int count = std::min(kRows, rows.last() - first);
    for (int i = 0; i < count; ++i) {
      int begin = 0;
      int end = 0;
      rows.columns(first + i, begin, end);
      const double* row = prefix + static_cast<std::size_t>(first + i) * row_size;
      const Ends at{row + static_cast<std::size_t>(begin) * kStride,
                    row + static_cast<std::size_t>(end) * kStride};
      prefetch<kStride>(at.p);
      prefetch<kStride>(at.q);
      ends[static_cast<std::size_t>(i)] = at;
    }
    for (int i = 0; i < count; ++i) {
      const auto [p, q] = ends[static_cast<std::size_t>(i)];
      const double centre = first + i + 0.5;
      for (std::size_t k = 0; k < kStride; ++k) {
        const double d = q[k] - p[k];
        sum[k] += d;
        y_sum[k] += centre * d;
      }
      yy += centre * centre * (q[kW] - p[kW]);
    }
  }
  Moments m;
  m.w = sum[kW];
  m.x = sum[kX];
  m.xx = sum[kXX];
  m.squares = sum[kSquares];
  m.y = y_sum[kW];
  m.xy = y_sum[kX];
  m.yy = yy;
  for (std::size_t c = 0; c < C; ++c) {
    m.c[c] = sum[kColour + c];
    m.xc[c] = sum[kColour + C + c];
    m.yc[c] = y_sum[kColour + c];
  }
  return m;
}

KNOTREEL_MULTIVERSION
Moments sum_triangle(const TriangleRows& rows, const double* prefix, std::size_t row_size, int channels) {
  switch (channels) {
    case 1:
      return sum_rows<1>(rows, prefix, row_size);
    case 2:
      return sum_rows<2>(rows, prefix, row_size);
    case 3:
      return sum_rows<3>(rows, prefix, row_size);
    default:
      return sum_rows<4>(rows, prefix, row_size);
  }
}

}  // namespace

TriangleRows::TriangleRows(const std::array<Vec2, 3>& triangle, int width, int height) : width_(width) {
  std::array<Vec2, 3> p = triangle;
  // By y, ties by x: both triangles on an edge then compute it from the same end.
  const auto before = [](Vec2 a, Vec2 b) { return a.y != b.y ? a.y < b.y : a.x < b.x; };
  if (before(p[1], p[0])) std::swap(p[0], p[1]);
  if (before(p[2], p[1])) std::swap(p[1], p[2]);
  if (before(p[1], p[0])) std::swap(p[0], p[1]);
  first_ = std::max(0, TriangleRows::first_centre(p[0].y));
  last_ = std::min(height, TriangleRows::first_centre(p[2].y));
  const auto line = [](Vec2 a, Vec2 b) {
    return Line{a.x, a.y, b.y > a.y ? (b.x - a.x) / (b.y - a.y) : 0.0, b.y};
  };
  long_ = line(p[0], p[2]);
  upper_ = line(p[0], p[1]);
  lower_ = line(p[1], p[2]);
  long_is_left_ = cross(p[2] - p[0], p[1] - p[0]) < 0;
}

Target::Target(image::Image image, std::vector<float> weights)
    : image_(std::move(image)), weights_(std::move(weights)) {
  if (!weights_.empty() && weights_.size() != image_.pixel_count()) {
    throw Error(ErrorKind::kInvalidArgument, "a picture needs one weight per pixel");
  }
  const auto channels = static_cast<std::size_t>(image_.channels);
  const auto width = static_cast<std::size_t>(image_.width);
  stride_ = kColour + 2 * channels;
  prefix_ = std::make_unique_for_overwrite<double[]>(static_cast<std::size_t>(image_.height) * (width + 1) *
                                                     stride_);
  parallel_for(static_cast<std::size_t>(image_.height), [&](std::size_t y) {
    double* at = prefix_.get() + y * (width + 1) * stride_;
    std::fill_n(at, stride_, 0.0);
    const float* pixel = image_.row(static_cast<int>(y)).data();
    for (std::size_t x = 0; x < width; ++x, at += stride_, pixel += channels) {
      const double w = weights_.empty() ? 1.0 : static_cast<double>(weights_[y * width + x]);
      const double centre = static_cast<double>(x) + 0.5;
      double squares = 0;
      double* to = at + stride_;
      for (std::size_t c = 0; c < channels; ++c) {
        const double v = static_cast<double>(pixel[c]);
        squares += v * v;
        to[kColour + c] = at[kColour + c] + w * v;
        to[kColour + channels + c] = at[kColour + channels + c] + w * centre * v;
      }
      to[kW] = at[kW] + w;
      to[kX] = at[kX] + w * centre;
      to[kXX] = at[kXX] + w * centre * centre;
      to[kSquares] = at[kSquares] + w * squares;
    }
  });
}

Moments Target::moments(const std::array<Vec2, 3>& triangle) const {
  const TriangleRows rows(triangle, image_.width, image_.height);
  return sum_triangle(rows, prefix_.get(), (static_cast<std::size_t>(image_.width) + 1) * stride_,
                      image_.channels);
}

Moments Moments::operator+(const Moments& m) const {
  Moments sum{w + m.w, x + m.x, y + m.y, xx + m.xx, xy + m.xy, yy + m.yy, squares + m.squares, c, xc, yc};
  for (std::size_t i = 0; i < 4; ++i) {
    sum.c[i] += m.c[i];
    sum.xc[i] += m.xc[i];
    sum.yc[i] += m.yc[i];
  }
  return sum;
}

LinearFit Target::fit(const std::array<Vec2, 3>& triangle) const {
  LinearFit result = fit(moments(triangle));
  if (result.weight <= 0) result.centre = (1.0 / 3) * (triangle[0] + triangle[1] + triangle[2]);
  return result;
}

LinearFit Target::fit(const Moments& m) const {
  LinearFit fit;
  fit.weight = m.w;
  if (m.w <= 0) return fit;
  fit.centre = {m.x / m.w, m.y / m.w};
  const double xx = m.xx - fit.centre.x * m.x + kSlopeRidge;
  const double xy = m.xy - fit.centre.x * m.y;
  const double yy = m.yy - fit.centre.y * m.y + kSlopeRidge;
  const double scale = 1 / (xx * yy - xy * xy);
  double explained = 0;
  for (std::size_t c = 0; c < static_cast<std::size_t>(image_.channels); ++c) {
    fit.value[c] = m.c[c] / m.w;
    const double xc = m.xc[c] - fit.centre.x * m.c[c];
    const double yc = m.yc[c] - fit.centre.y * m.c[c];
    fit.gradient[c] = {scale * (yy * xc - xy * yc), scale * (xx * yc - xy * xc)};
    explained += fit.value[c] * m.c[c] + fit.gradient[c].x * xc + fit.gradient[c].y * yc;
  }
  fit.error = std::max(0.0, m.squares - explained);
  return fit;
}

double Target::error(const std::array<Vec2, 3>& triangle) const {
  return fit(triangle).error;
}

std::array<double, 4> Target::colour(Vec2 u) const {
  const double px = std::clamp(u.x - 0.5, 0.0, static_cast<double>(image_.width - 1));
  const double py = std::clamp(u.y - 0.5, 0.0, static_cast<double>(image_.height - 1));
  const int x = std::min(static_cast<int>(px), std::max(0, image_.width - 2));
  const int y = std::min(static_cast<int>(py), std::max(0, image_.height - 2));
  const double fx = px - x;
  const double fy = py - y;
  const auto channels = static_cast<std::size_t>(image_.channels);
  const std::size_t right = image_.width > 1 ? channels : 0;
  const std::size_t below = image_.height > 1 ? image_.row_size() : 0;
  const float* p = image_.samples.data() + pixel(x, y) * channels;
  std::array<double, 4> result{};
  for (std::size_t c = 0; c < channels; ++c) {
    const double top = (1 - fx) * static_cast<double>(p[c]) + fx * static_cast<double>(p[right + c]);
    const double low =
        (1 - fx) * static_cast<double>(p[below + c]) + fx * static_cast<double>(p[below + right + c]);
    result[c] = (1 - fy) * top + fy * low;
  }
  return result;
}

}  // namespace knotreel::knots
