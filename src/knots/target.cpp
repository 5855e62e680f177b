// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/knots/target.h"

#include <algorithm>
#include <cstring>
#include <type_traits>

#include "base/multiversion.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::knots {

namespace {

/// Where the prefix sums of a pixel are among its numbers: of w c for each channel, of x w c, of w |c|^2; and
/// of w, x w and x^2 w, unless all weights are 1. They are kept for every so many pixels; those in between
/// are added up when they are needed, in the same order, to the same bits.
template <std::size_t C, bool Weighted, std::size_t Every>
struct Layout {
  static constexpr std::size_t kChannels = C;
  static constexpr bool kWeighted = Weighted;
  static constexpr std::size_t kEvery = Every;
  static constexpr std::size_t kColour = 0, kXColour = C, kSquares = 2 * C;
  static constexpr std::size_t kW = 2 * C + 1, kX = kW + 1, kXX = kX + 1;
  static constexpr std::size_t kUsed = Weighted ? kXX + 1 : kW;
  static constexpr std::size_t kStride = kUsed == 7 ? 8 : kUsed;  ///< as many as a cache line holds

  static constexpr std::size_t row_size(std::size_t width) { return (width / Every + 1) * kStride; }
};

/// Storage::kCompact keeps every fourth.
constexpr std::size_t kEveryFourth = 4;

/// Draws slopes that few pixels decide towards zero: this many pixels at distance one say that there is none.
constexpr double kSlopeRidge = 1.0;

/// Asks for memory that will be read soon: for places that no hardware could foresee.
template <std::size_t Count>
[[gnu::always_inline]] inline void prefetch(const double* p) {
#if defined(__GNUC__)
  constexpr std::size_t kLine = 64 / sizeof(double);
  for (std::size_t i = 0; i < Count; i += kLine) __builtin_prefetch(p + i);
  if constexpr (Count != kLine) __builtin_prefetch(p + Count - 1);
#else
  (void)p;
#endif
}

/// A row of the picture with its weights, of no meaning if there are none, and its prefix sums.
struct Row {
  const float* pixels;
  const float* weights;
  const double* prefix;
};

/// A picture with its prefix sums.
struct Sums {
  const float* pixels;
  const float* weights;
  const double* prefix;
  std::size_t width;
  bool compact;

  template <class Slot>
  [[gnu::always_inline]] Row row(std::size_t y) const {
    return {pixels + y * width * Slot::kChannels, Slot::kWeighted ? weights + y * width : nullptr,
            prefix + y * Slot::row_size(width)};
  }
};

/// Adds column x of a row to the prefix sums up to it. @param after may be the same place.
template <class Slot>
[[gnu::always_inline]] inline void add_pixel(const Row& row, std::size_t x, const double* before,
                                             double* after) {
  const double w = Slot::kWeighted ? static_cast<double>(row.weights[x]) : 1.0;
  const double centre = static_cast<double>(x) + 0.5;
  double squares = 0;
  for (std::size_t c = 0; c < Slot::kChannels; ++c) {
    const double v = static_cast<double>(row.pixels[x * Slot::kChannels + c]);
    squares += v * v;
    after[Slot::kColour + c] = before[Slot::kColour + c] + w * v;
    after[Slot::kXColour + c] = before[Slot::kXColour + c] + w * centre * v;
  }
  after[Slot::kSquares] = before[Slot::kSquares] + w * squares;
  if constexpr (Slot::kWeighted) {
    after[Slot::kW] = before[Slot::kW] + w;
    after[Slot::kX] = before[Slot::kX] + w * centre;
    after[Slot::kXX] = before[Slot::kXX] + w * centre * centre;
  }
  std::fill(after + Slot::kUsed, after + Slot::kStride, 0.0);
}

/// Prefix sums up to a column. @param room for them where they are not kept.
template <class Slot>
[[gnu::always_inline]] inline const double* sums_before(const Row& row, int column, double* room) {
  const auto x = static_cast<std::size_t>(column);
  const std::size_t kept = x / Slot::kEvery;
  const double* const there = row.prefix + kept * Slot::kStride;
  if constexpr (Slot::kEvery == 1) return there;
  std::copy_n(there, Slot::kStride, room);
  for (std::size_t i = kept * Slot::kEvery; i < x; ++i) add_pixel<Slot>(row, i, room, room);
  return room;
}

/// Asks for the memory that sums_before() will read.
template <class Slot>
[[gnu::always_inline]] inline void prefetch_sums(const Row& row, int column) {
  const std::size_t kept = static_cast<std::size_t>(column) / Slot::kEvery;
  prefetch<Slot::kStride>(row.prefix + kept * Slot::kStride);
#if defined(__GNUC__)
  if constexpr (Slot::kEvery != 1) __builtin_prefetch(row.pixels + kept * Slot::kEvery * Slot::kChannels);
#endif
}

/// Sums of one triangle. Where its rows begin and end is found first: their sums are fetched from memory at
/// the same time then, not one after the other.
template <class Slot>
[[gnu::always_inline]] inline Moments sum_rows(const TriangleRows& rows, const Sums& sums) {
  constexpr std::size_t kStride = Slot::kStride;
  constexpr int kRows = 32;  // at a time
  struct Ends {
    int begin;
    int end;
  };
  std::array<Ends, kRows> ends;
  double sum[kStride] = {};
  double y_sum[kStride] = {};
  double p_room[kStride];
  double q_room[kStride];
  Moments m;
  double xx12 = 0;  // 12 times that of m, a sum of whole numbers
  for (int first = rows.first(); first < rows.last(); first += kRows) {
    const int count = std::min(kRows, rows.last() - first);
    for (int i = 0; i < count; ++i) {
      Ends& at = ends[static_cast<std::size_t>(i)];
      rows.columns(first + i, at.begin, at.end);
      const Row row = sums.row<Slot>(static_cast<std::size_t>(first + i));
      prefetch_sums<Slot>(row, at.begin);
      prefetch_sums<Slot>(row, at.end);
    }
    for (int i = 0; i < count; ++i) {
      const Row row = sums.row<Slot>(static_cast<std::size_t>(first + i));
      const Ends at = ends[static_cast<std::size_t>(i)];
      const double* const p = sums_before<Slot>(row, at.begin, p_room);
      const double* const q = sums_before<Slot>(row, at.end, q_room);
      const double begin = at.begin;
      const double end = at.end;
      const double centre = first + i + 0.5;
      for (std::size_t k = 0; k < kStride; ++k) {
        const double d = q[k] - p[k];
        sum[k] += d;
        y_sum[k] += centre * d;
      }
      double w = end - begin;
      if constexpr (Slot::kWeighted) {
        w = q[Slot::kW] - p[Slot::kW];
      } else {
        const double x = 0.5 * (end * end - begin * begin);
        m.w += w;
        m.y += centre * w;
        m.x += x;
        m.xy += centre * x;
        xx12 += end * (4 * end * end - 1) - begin * (4 * begin * begin - 1);
      }
      m.yy += centre * centre * w;
    }
  }
  if constexpr (Slot::kWeighted) {
    m.w = sum[Slot::kW];
    m.x = sum[Slot::kX];
    m.xx = sum[Slot::kXX];
    m.y = y_sum[Slot::kW];
    m.xy = y_sum[Slot::kX];
  } else {
    m.xx = xx12 / 12;
  }
  m.squares = sum[Slot::kSquares];
  for (std::size_t c = 0; c < Slot::kChannels; ++c) {
    m.c[c] = sum[Slot::kColour + c];
    m.xc[c] = sum[Slot::kXColour + c];
    m.yc[c] = y_sum[Slot::kColour + c];
  }
  return m;
}

template <std::size_t C, bool Weighted>
[[gnu::always_inline]] inline Moments sum_rows(const TriangleRows& rows, const Sums& sums) {
  return sums.compact ? sum_rows<Layout<C, Weighted, kEveryFourth>>(rows, sums)
                      : sum_rows<Layout<C, Weighted, 1>>(rows, sums);
}

template <std::size_t C>
[[gnu::always_inline]] inline Moments sum_rows(const TriangleRows& rows, const Sums& sums, bool weighted) {
  return weighted ? sum_rows<C, true>(rows, sums) : sum_rows<C, false>(rows, sums);
}

KNOTREEL_MULTIVERSION
Moments sum_triangle(const TriangleRows& rows, const Sums& sums, int channels, bool weighted) {
  switch (channels) {
    case 1:
      return sum_rows<1>(rows, sums, weighted);
    case 2:
      return sum_rows<2>(rows, sums, weighted);
    case 3:
      return sum_rows<3>(rows, sums, weighted);
    default:
      return sum_rows<4>(rows, sums, weighted);
  }
}

/// Prefix sums along a row of pixels. @param to room for those that are kept.
template <class Slot>
void add_up(const Row& row, std::size_t width, double* to) {
  std::fill_n(to, Slot::kStride, 0.0);
  for (std::size_t x = 0; x + Slot::kEvery <= width; x += Slot::kEvery, to += Slot::kStride) {
    double* const next = to + Slot::kStride;
    add_pixel<Slot>(row, x, to, next);
    for (std::size_t i = 1; i < Slot::kEvery; ++i) add_pixel<Slot>(row, x + i, next, next);
  }
}

/// Calls visit(layout), known to the compiler.
template <class Visit>
void by_kind(int channels, bool weighted, bool compact, Visit&& visit) {
  const auto with = [&]<std::size_t C>(std::integral_constant<std::size_t, C>) {
    if (compact) {
      weighted ? visit(Layout<C, true, kEveryFourth>()) : visit(Layout<C, false, kEveryFourth>());
    } else {
      weighted ? visit(Layout<C, true, 1>()) : visit(Layout<C, false, 1>());
    }
  };
  switch (channels) {
    case 1:
      return with(std::integral_constant<std::size_t, 1>{});
    case 2:
      return with(std::integral_constant<std::size_t, 2>{});
    case 3:
      return with(std::integral_constant<std::size_t, 3>{});
    default:
      return with(std::integral_constant<std::size_t, 4>{});
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

Target::Target(image::Image image, std::vector<float> weights, Storage storage)
    : image_(std::move(image)), weights_(std::move(weights)), compact_(storage == Storage::kCompact) {
  if (!weights_.empty() && weights_.size() != image_.pixel_count()) {
    throw Error(ErrorKind::kInvalidArgument, "a picture needs one weight per pixel");
  }
  const auto width = static_cast<std::size_t>(image_.width);
  const auto height = static_cast<std::size_t>(image_.height);
  by_kind(image_.channels, !weights_.empty(), compact_, [&](auto layout) {
    constexpr std::size_t kPerLine = sizeof(Line) / sizeof(double);
    prefix_ =
        std::make_unique_for_overwrite<Line[]>((height * layout.row_size(width) + kPerLine - 1) / kPerLine);
  });
  parallel_for(height, [&](std::size_t y) { add_up_row(y); });
}

void Target::add_up_row(std::size_t y) {
  const auto width = static_cast<std::size_t>(image_.width);
  double* const prefix = prefix_.get()->data();
  const Sums sums{image_.samples.data(), weights_.data(), prefix, width, compact_};
  by_kind(image_.channels, !weights_.empty(), compact_, [&]<class Slot>(Slot) {
    add_up<Slot>(sums.row<Slot>(y), width, prefix + y * Slot::row_size(width));
  });
}

void Target::change_to(const image::Image& image) {
  if (image.width != image_.width || image.height != image_.height || image.channels != image_.channels)
    throw Error(ErrorKind::kInvalidArgument, "a picture has another size than the one before");
  parallel_for(static_cast<std::size_t>(image_.height), [&](std::size_t y) {
    const auto now = image.row(static_cast<int>(y));
    const auto here = image_.row(static_cast<int>(y));
    if (std::memcmp(now.data(), here.data(), now.size_bytes()) == 0) return;
    std::copy(now.begin(), now.end(), here.begin());
    add_up_row(y);
  });
}

Moments Target::moments(const std::array<Vec2, 3>& triangle) const {
  const TriangleRows rows(triangle, image_.width, image_.height);
  const Sums sums{image_.samples.data(), weights_.data(), prefix_.get()->data(),
                  static_cast<std::size_t>(image_.width), compact_};
  return sum_triangle(rows, sums, image_.channels, !weights_.empty());
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

}  // namespace knotreel::knots
