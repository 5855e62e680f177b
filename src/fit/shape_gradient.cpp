// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/shape_gradient.h"

#include <algorithm>

#include "base/lanes.h"
#include "base/multiversion.h"
#include "knotreel/spline/pixel_values.h"

namespace knotreel::fit {

using spline::Affine;
using spline::Piece;
using spline::PieceTerm;

namespace {

constexpr std::size_t kPixels = spline::PixelValues::kTilePixels;
constexpr std::size_t kLanes = 8;
constexpr std::size_t kPlanes = ShapeGradient::kPlanes;

/// Pixels that are summed side by side: a fixed order, whatever the width of vectors.
using PixelLanes = LanesOf<float, kLanes>;
using Lanes = PixelLanes::Type;

using SinglePlane = spline::PlaneIn<float>;

[[gnu::always_inline]] inline SinglePlane single(const Plane& p) {
  return {static_cast<float>(p.c), static_cast<float>(p.x), static_cast<float>(p.y)};
}

template <std::size_t N>
[[gnu::always_inline]] inline std::array<SinglePlane, N> singles(const std::array<Plane, N>& planes) {
  std::array<SinglePlane, N> result;
  for (std::size_t i = 0; i < N; ++i) result[i] = single(planes[i]);
  return result;
}

/// The quantities of the pixels of a tile whose moments are taken: o0 to o3 for the slopes, each where it
/// rules, of for the factor and p0 to p2 for the weights. S: the number of slopes; quantities of those
/// missing are not set.
template <int S, bool Walls, bool Factor>
[[gnu::always_inline]] inline void fill_quantities(const Shape& s, const float* __restrict x,
                                                   const float* __restrict y, const float* __restrict q0,
                                                   const float* __restrict q1, const float* __restrict q2,
                                                   float* __restrict o0, float* __restrict o1,
                                                   float* __restrict o2, float* __restrict o3,
                                                   float* __restrict of, float* __restrict p0,
                                                   float* __restrict p1, float* __restrict p2) {
  const auto [s0, s1, s2, s3] = singles(s.slopes);
  const auto [a0, a1, a2] = singles(s.walls);
  const auto [w0, w1, w2] = singles(s.weights);
  const SinglePlane wf = single(s.factor);
  for (std::size_t i = 0; i < kPixels; ++i) {
    const float ux = x[i];
    const float uy = y[i];
    const auto at = [ux, uy](const SinglePlane& p) { return p.c + p.x * ux + p.y * uy; };
    const float v0 = at(s0);
    float v1 = 0, v2 = 0;
    float least = v0;
    if constexpr (S > 1) least = (v1 = at(s1)) < least ? v1 : least;
    if constexpr (S > 2) least = (v2 = at(s2)) < least ? v2 : least;
    if constexpr (S > 3) least = at(s3) < least ? at(s3) : least;
    // Each pixel counts for the slope that rules there; ties go to the first. Products with 0 or 1, because
    // choices that depend on each other keep the compiler from using vectors.
    float positive = least > 0 ? 1.0F : 0.0F;
    if constexpr (Walls) {
      const float d0 = at(a0);
      const float d1 = at(a1);
      const float d2 = at(a2);
      const float d01 = d1 < d0 ? d1 : d0;
      const float d = d2 < d01 ? d2 : d01;
      positive *= d > 0 ? 1.0F : 0.0F;
    }
    float v = least * positive;
    const float share = at(w0) * q0[i] + at(w1) * q1[i] + at(w2) * q2[i];
    float slope = share * positive;
    if constexpr (Factor) {
      const float f = at(wf);
      of[i] = v * share;
      v *= f;
      slope *= f;
    }
    if constexpr (S > 1) {
      const float rules = v0 <= least ? 1.0F : 0.0F;
      o0[i] = slope * rules;
      slope -= slope * rules;
    }
    if constexpr (S > 2) {
      const float rules = v1 <= least ? 1.0F : 0.0F;
      o1[i] = slope * rules;
      slope -= slope * rules;
    }
    if constexpr (S > 3) {
      const float rules = v2 <= least ? 1.0F : 0.0F;
      o2[i] = slope * rules;
      slope -= slope * rules;
    }
    float* const last = S > 3 ? o3 : S > 2 ? o2 : S > 1 ? o1 : o0;
    last[i] = slope;
    p0[i] = v * q0[i];
    p1[i] = v * q1[i];
    p2[i] = v * q2[i];
  }
}

template <bool Walls, bool Factor>
[[gnu::always_inline]] inline void fill_by_slopes(const Shape& s, const float* x, const float* y,
                                                  const float* const* q, float* const* o) {
  switch (s.slope_count) {
    case 1:
      return fill_quantities<1, Walls, Factor>(s, x, y, q[0], q[1], q[2], o[0], o[1], o[2], o[3], o[4], o[5],
                                               o[6], o[7]);
    case 2:
      return fill_quantities<2, Walls, Factor>(s, x, y, q[0], q[1], q[2], o[0], o[1], o[2], o[3], o[4], o[5],
                                               o[6], o[7]);
    case 3:
      return fill_quantities<3, Walls, Factor>(s, x, y, q[0], q[1], q[2], o[0], o[1], o[2], o[3], o[4], o[5],
                                               o[6], o[7]);
    default:
      return fill_quantities<4, Walls, Factor>(s, x, y, q[0], q[1], q[2], o[0], o[1], o[2], o[3], o[4], o[5],
                                               o[6], o[7]);
  }
}

/// The sums of the lanes of eight vectors.
[[gnu::always_inline]] inline void sum_lanes(const Lanes* v, Lanes& sums) {
  Lanes pairs[4];
  for (std::size_t i = 0; i < 4; ++i) {
    pairs[i] = __builtin_shufflevector(v[2 * i], v[2 * i + 1], 0, 8, 2, 10, 4, 12, 6, 14) +
               __builtin_shufflevector(v[2 * i], v[2 * i + 1], 1, 9, 3, 11, 5, 13, 7, 15);
  }
  Lanes fours[2];
  for (std::size_t i = 0; i < 2; ++i) {
    fours[i] = __builtin_shufflevector(pairs[2 * i], pairs[2 * i + 1], 0, 1, 8, 9, 4, 5, 12, 13) +
               __builtin_shufflevector(pairs[2 * i], pairs[2 * i + 1], 2, 3, 10, 11, 6, 7, 14, 15);
  }
  sums = __builtin_shufflevector(fours[0], fours[1], 0, 1, 2, 3, 8, 9, 10, 11) +
         __builtin_shufflevector(fours[0], fours[1], 4, 5, 6, 7, 12, 13, 14, 15);
}

/// Sums of quantities, of them times x and of them times y, relative to another origin.
/// @param used whether there is such a quantity.
[[gnu::always_inline]] inline void add_moments(const float* x, const float* y,
                                               const float (*quantities)[kPixels], const bool* used,
                                               Vec2 offset, ShapeGradient& gradient) {
  Lanes c[kPlanes];
  Lanes cx[kPlanes];
  Lanes cy[kPlanes];
  for (std::size_t k = 0; k < kPlanes; ++k) {
    Lanes sum{};
    Lanes sum_x{};
    Lanes sum_y{};
    for (std::size_t i = 0; used[k] && i < kPixels; i += kLanes) {
      Lanes o, ux, uy;
      PixelLanes::load(quantities[k] + i, o);
      PixelLanes::load(x + i, ux);
      PixelLanes::load(y + i, uy);
      sum += o;
      sum_x += o * ux;
      sum_y += o * uy;
    }
    c[k] = sum;
    cx[k] = sum_x;
    cy[k] = sum_y;
  }
  Lanes one;
  Lanes by_x;
  Lanes by_y;
  sum_lanes(c, one);
  sum_lanes(cx, by_x);
  sum_lanes(cy, by_y);
  for (std::size_t k = 0; k < kPlanes; ++k) {
    gradient.c[k] += static_cast<double>(one[k]);
    gradient.x[k] += static_cast<double>(by_x[k]) + offset.x * static_cast<double>(one[k]);
    gradient.y[k] += static_cast<double>(by_y[k]) + offset.y * static_cast<double>(one[k]);
  }
}

}  // namespace

Shape shape_of(const Piece& piece, const PieceTerm& term, Vec2 origin) {
  Shape s;
  s.slopes[0] = {term.tent.constant, 0, 0};
  for (std::size_t i = 0; i < static_cast<std::size_t>(term.tent.slope_count); ++i) {
    s.slopes[i] = plane_of(term.tent.slopes[i], origin);
  }
  s.slope_count = static_cast<std::size_t>(std::max(1, term.tent.slope_count));
  s.wall_count = static_cast<std::size_t>(term.tent.wall_count);
  for (std::size_t i = 0; i < s.wall_count; ++i) s.walls[i] = plane_of(term.tent.walls[i], origin);
  s.has_factor = term.has_factor;
  if (term.has_factor) s.factor = plane_of(term.factor, origin);
  for (std::size_t i = 0; i < 3; ++i) s.weights[i] = plane_of(piece.weights[i], origin);
  return s;
}

void add_to(ShapeGradient& sum, const ShapeGradient& gradient) {
  for (std::size_t i = 0; i < kPlanes; ++i) {
    sum.c[i] += gradient.c[i];
    sum.x[i] += gradient.x[i];
    sum.y[i] += gradient.y[i];
  }
}

double change(const ShapeGradient& g, const Shape& from, const Shape& to) {
  const auto of = [&g](std::size_t plane, const Plane& p) {
    return p.c * g.c[plane] + p.x * g.x[plane] + p.y * g.y[plane];
  };
  double sum = of(ShapeGradient::kFactor, to.factor - from.factor);
  for (std::size_t i = 0; i < 4; ++i) sum += of(i, to.slopes[i] - from.slopes[i]);
  for (std::size_t i = 0; i < 3; ++i) sum += of(ShapeGradient::kWeights + i, to.weights[i] - from.weights[i]);
  return sum;
}

void add_affine(const Shape& s, const ShapeGradient& g, std::array<Vec2, 3>& sum) {
  const auto add = [&](std::size_t plane, const Plane& p) {
    const Vec2 slope{p.x, p.y};
    sum[0] = sum[0] - g.c[plane] * slope;
    sum[1] = sum[1] - g.x[plane] * slope;
    sum[2] = sum[2] - g.y[plane] * slope;
  };
  for (std::size_t i = 0; i < s.slope_count; ++i) add(i, s.slopes[i]);
  if (s.has_factor) add(ShapeGradient::kFactor, s.factor);
  for (std::size_t i = 0; i < 3; ++i) add(ShapeGradient::kWeights + i, s.weights[i]);
}

KNOTREEL_MULTIVERSION
void add_pixels(const Shape& s, const float* x, const float* y, const float* const* q, Vec2 offset,
                ShapeGradient& gradient) {
  float quantities[kPlanes][kPixels];
  float* o[kPlanes];
  for (std::size_t k = 0; k < kPlanes; ++k) o[k] = quantities[k];
  if (s.has_factor) {
    fill_by_slopes<true, true>(s, x, y, q, o);
  } else if (s.wall_count > 0) {
    fill_by_slopes<true, false>(s, x, y, q, o);
  } else {
    fill_by_slopes<false, false>(s, x, y, q, o);
  }
  const bool used[kPlanes] = {
      true, s.slope_count > 1, s.slope_count > 2, s.slope_count > 3, s.has_factor, true, true, true};
  add_moments(x, y, quantities, used, offset, gradient);
}

}  // namespace knotreel::fit
