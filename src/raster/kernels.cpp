// SPDX-License-Identifier: GPL-3.0-or-later
#include "raster/kernels.h"

#include <algorithm>
#include <cmath>

#include "base/multiversion.h"

namespace knotreel::raster {

namespace {

/// What a loop needs of a term, padded so that few shapes of tents are left: S slopes of 0, 2, 3 or 4 (one
/// slope counts twice), W walls of 0, 2 or 3 (missing ones are always passed).
template <int S, int W>
struct LoopTent {
  std::array<spline::Affine, 4> slopes;
  std::array<spline::Affine, 3> walls{};
  std::array<double, 3> least{};  ///< smallest distance that counts as inside
  double constant;

  explicit LoopTent(const spline::Tent& tent) : slopes(tent.slopes), constant(tent.constant) {
    if (tent.slope_count == 1) slopes[1] = slopes[0];
    for (std::size_t k = 0; k < 3; ++k) {
      least[k] = -1;  // a wall that is not there has distance 0
      if (k >= static_cast<std::size_t>(tent.wall_count)) continue;
      walls[k] = tent.walls[k];
      const bool inside = walls[k].nx * kDirection.x + walls[k].ny * kDirection.y > 0;
      least[k] = inside ? -spline::kOnWall : spline::kOnWall;
    }
  }
};

#define KNOTREEL_INLINE [[gnu::always_inline]] inline

KNOTREEL_INLINE double at(const spline::Affine& a, double x, double y) {
  return a.nx * (x - a.px) + a.ny * (y - a.py);
}

KNOTREEL_INLINE void lower(const spline::Affine& a, double x, double y, double& v) {
  const double w = at(a, x, y);
  v = w < v ? w : v;
}

KNOTREEL_INLINE void lower(const spline::Affine& a, double x, double y, double& v, double& gx, double& gy) {
  const double w = at(a, x, y);
  const bool below = w < v;
  gx = below ? a.nx : gx;
  gy = below ? a.ny : gy;
  v = below ? w : v;
}

template <int S, int W>
KNOTREEL_INLINE double tent_at(const LoopTent<S, W>& t, double x, double y) {
  double v = t.constant;
  if constexpr (S > 0) v = at(t.slopes[0], x, y);
  if constexpr (S > 1) lower(t.slopes[1], x, y, v);
  if constexpr (S > 2) lower(t.slopes[2], x, y, v);
  if constexpr (S > 3) lower(t.slopes[3], x, y, v);
  if constexpr (W > 0) v = at(t.walls[0], x, y) >= t.least[0] ? v : 0;
  if constexpr (W > 1) v = at(t.walls[1], x, y) >= t.least[1] ? v : 0;
  if constexpr (W > 2) v = at(t.walls[2], x, y) >= t.least[2] ? v : 0;
  return v > 0 ? v : 0;
}

template <int S, int W>
KNOTREEL_INLINE double tent_at(const LoopTent<S, W>& t, double x, double y, double& gx, double& gy) {
  double v = t.constant;
  gx = 0;
  gy = 0;
  if constexpr (S > 0) {
    v = at(t.slopes[0], x, y);
    gx = t.slopes[0].nx;
    gy = t.slopes[0].ny;
  }
  if constexpr (S > 1) lower(t.slopes[1], x, y, v, gx, gy);
  if constexpr (S > 2) lower(t.slopes[2], x, y, v, gx, gy);
  if constexpr (S > 3) lower(t.slopes[3], x, y, v, gx, gy);
  if constexpr (W > 0) v = at(t.walls[0], x, y) >= t.least[0] ? v : 0;
  if constexpr (W > 1) v = at(t.walls[1], x, y) >= t.least[1] ? v : 0;
  if constexpr (W > 2) v = at(t.walls[2], x, y) >= t.least[2] ? v : 0;
  const bool inside = v > 0;
  gx = inside ? gx : 0;
  gy = inside ? gy : 0;
  return inside ? v : 0;
}

template <int S, int W, bool Factor>
KNOTREEL_INLINE void geometry_loop(const SurfaceTerm& term, const double* __restrict ux,
                                   const double* __restrict uy, int n, double* __restrict d0,
                                   double* __restrict d1, double* __restrict j00, double* __restrict j01,
                                   double* __restrict j10, double* __restrict j11) {
  const LoopTent<S, W> tent(term.tent);
  const spline::Affine f = term.factor;
  const Vec2 o = term.origin;
  const Plane p = term.planes[0];
  const Plane q = term.planes[1];
  for (int i = 0; i < n; ++i) {
    double gx;
    double gy;
    double v = tent_at(tent, ux[i], uy[i], gx, gy);
    if constexpr (Factor) {
      const double w = at(f, ux[i], uy[i]);
      gx = gx * w + v * f.nx;
      gy = gy * w + v * f.ny;
      v *= w;
    }
    const double dx = ux[i] - o.x;
    const double dy = uy[i] - o.y;
    const double a = p.value + p.gx * dx + p.gy * dy;
    const double b = q.value + q.gx * dx + q.gy * dy;
    d0[i] += v * a;
    j00[i] += gx * a + v * p.gx;
    j01[i] += gy * a + v * p.gy;
    d1[i] += v * b;
    j10[i] += gx * b + v * q.gx;
    j11[i] += gy * b + v * q.gy;
  }
}

template <int S, int W, bool Factor>
KNOTREEL_INLINE void colour_loop(const SurfaceTerm& term, std::size_t channels, const double* __restrict ux,
                                 const double* __restrict uy, int n, double* __restrict out) {
  const LoopTent<S, W> tent(term.tent);
  const spline::Affine f = term.factor;
  const Vec2 o = term.origin;
  const auto loop = [&](auto count) __attribute__((always_inline)) {
    constexpr std::size_t kCount = decltype(count)::value;
    const std::array<Plane, 4> p{term.planes[2], term.planes[3], term.planes[4], term.planes[5]};
    for (int i = 0; i < n; ++i) {
      double v = tent_at(tent, ux[i], uy[i]);
      if constexpr (Factor) v *= at(f, ux[i], uy[i]);
      const double dx = ux[i] - o.x;
      const double dy = uy[i] - o.y;
      out[i] += v * (p[0].value + p[0].gx * dx + p[0].gy * dy);
      if constexpr (kCount > 1) out[kBatch + i] += v * (p[1].value + p[1].gx * dx + p[1].gy * dy);
      if constexpr (kCount > 2) out[2 * kBatch + i] += v * (p[2].value + p[2].gx * dx + p[2].gy * dy);
      if constexpr (kCount > 3) out[3 * kBatch + i] += v * (p[3].value + p[3].gx * dx + p[3].gy * dy);
    }
  };
  switch (channels - kGeometryChannels) {
    case 1:
      return loop(std::integral_constant<std::size_t, 1>{});
    case 2:
      return loop(std::integral_constant<std::size_t, 2>{});
    case 3:
      return loop(std::integral_constant<std::size_t, 3>{});
    default:
      return loop(std::integral_constant<std::size_t, 4>{});
  }
}

/// Calls body with the shape of a tent as constants: slopes, walls, and whether there is a factor.
template <class Body>
KNOTREEL_INLINE void with_shape(const SurfaceTerm& term, Body&& body) {
  const int s = term.tent.slope_count;
  const int w = term.tent.wall_count;
  const auto pick = [&](auto factor) __attribute__((always_inline)) {
    if (s == 0) return body(std::integral_constant<int, 0>{}, std::integral_constant<int, 3>{}, factor);
    if (w > 0) return body(std::integral_constant<int, 2>{}, std::integral_constant<int, 2>{}, factor);
    if (s <= 2) return body(std::integral_constant<int, 2>{}, std::integral_constant<int, 0>{}, factor);
    if (s == 3) return body(std::integral_constant<int, 3>{}, std::integral_constant<int, 0>{}, factor);
    return body(std::integral_constant<int, 4>{}, std::integral_constant<int, 0>{}, factor);
  };
  if (term.has_factor) {
    pick(std::true_type{});
  } else {
    pick(std::false_type{});
  }
}

}  // namespace

KNOTREEL_MULTIVERSION
void add_geometry(const SurfaceTerm& term, const double* ux, const double* uy, int n, GeometryBatch& g) {
  with_shape(
      term, [&](auto s, auto w, auto factor) __attribute__((always_inline)) {
        geometry_loop<decltype(s)::value, decltype(w)::value, decltype(factor)::value>(
            term, ux, uy, n, g.d[0].data(), g.d[1].data(), g.j[0][0].data(), g.j[0][1].data(),
            g.j[1][0].data(), g.j[1][1].data());
      });
}

KNOTREEL_MULTIVERSION
void add_colours(const SurfaceTerm& term, std::size_t channels, const double* ux, const double* uy, int n,
                 double* out) {
  with_shape(
      term, [&](auto s, auto w, auto factor) __attribute__((always_inline)) {
        colour_loop<decltype(s)::value, decltype(w)::value, decltype(factor)::value>(term, channels, ux, uy,
                                                                                     n, out);
      });
}

KNOTREEL_MULTIVERSION
void set_colour(const Quadratic& q, Vec2 o, const double* __restrict ux, const double* __restrict uy, int n,
                double* __restrict value) {
  for (int i = 0; i < n; ++i) {
    const double dx = ux[i] - o.x;
    const double dy = uy[i] - o.y;
    value[i] = q.c + dx * (q.x + q.xx * dx + q.xy * dy) + dy * (q.y + q.yy * dy);
  }
}

KNOTREEL_MULTIVERSION
void set_geometry(const Quadratic& q, Vec2 o, const double* __restrict ux, const double* __restrict uy, int n,
                  double* __restrict value, double* __restrict gx, double* __restrict gy) {
  for (int i = 0; i < n; ++i) {
    const double dx = ux[i] - o.x;
    const double dy = uy[i] - o.y;
    value[i] = q.c + dx * (q.x + q.xx * dx + q.xy * dy) + dy * (q.y + q.yy * dy);
    gx[i] = q.x + 2 * q.xx * dx + q.xy * dy;
    gy[i] = q.y + q.xy * dx + 2 * q.yy * dy;
  }
}

/// Quadratic interpolation of nine values on the square [0,2]^2 at n points, whose places are scaled to it.
KNOTREEL_MULTIVERSION
void interpolate(const std::array<double, 9>& node, Vec2 low, Vec2 size, const double* __restrict x,
                 const double* __restrict y, int n, double* __restrict out) {
  for (int i = 0; i < n; ++i) {
    const double s = 2 * (x[i] - low.x) / size.x;
    const double t = 2 * (y[i] - low.y) / size.y;
    const double s0 = 0.5 * (s - 1) * (s - 2);
    const double s1 = s * (2 - s);
    const double s2 = 0.5 * s * (s - 1);
    const double r0 = s0 * node[0] + s1 * node[1] + s2 * node[2];
    const double r1 = s0 * node[3] + s1 * node[4] + s2 * node[5];
    const double r2 = s0 * node[6] + s1 * node[7] + s2 * node[8];
    out[i] = 0.5 * (t - 1) * (t - 2) * r0 + t * (2 - t) * r1 + 0.5 * t * (t - 1) * r2;
  }
}

/// One Newton step for n points, clamped to the box, with the length of each in `moved`; returns the longest.
KNOTREEL_MULTIVERSION
double newton_step(const GeometryBatch& g, const double* __restrict x, const double* __restrict y, int n,
                   Vec2 low, Vec2 high, double* __restrict ux, double* __restrict uy,
                   double* __restrict moved) {
  for (int i = 0; i < n; ++i) {
    const double rx = x[i] - ux[i] - g.d[0][static_cast<std::size_t>(i)];
    const double ry = y[i] - uy[i] - g.d[1][static_cast<std::size_t>(i)];
    const double a = 1 + g.j[0][0][static_cast<std::size_t>(i)];
    const double b = g.j[0][1][static_cast<std::size_t>(i)];
    const double c = g.j[1][0][static_cast<std::size_t>(i)];
    const double e = 1 + g.j[1][1][static_cast<std::size_t>(i)];
    double det = a * e - b * c;
    // A folded or nearly singular map: step as if it were the identity.
    const bool bad = !(det > 0.05);
    det = bad ? 1 : det;
    const double sx = bad ? rx : (e * rx - b * ry) / det;
    const double sy = bad ? ry : (a * ry - c * rx) / det;
    double px = ux[i] + sx;
    double py = uy[i] + sy;
    px = px < low.x ? low.x : px;
    px = px > high.x ? high.x : px;
    py = py < low.y ? low.y : py;
    py = py > high.y ? high.y : py;
    moved[i] = std::abs(px - ux[i]) + std::abs(py - uy[i]);
    ux[i] = px;
    uy[i] = py;
  }
  return *std::max_element(moved, moved + n);
}

}  // namespace knotreel::raster
