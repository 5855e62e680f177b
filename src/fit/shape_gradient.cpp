#include "fit/shape_gradient.h"

#include <algorithm>

#include "base/multiversion.h"

namespace knotreel::fit {

using spline::Affine;
using spline::Piece;
using spline::PieceTerm;

namespace {

Plane plane_of(const Affine& a, Vec2 origin) {
  return {a(origin), a.nx, a.ny};
}

double dot(const Plane& p, const Plane& q) {
  return p.c * q.c + p.x * q.x + p.y * q.y;
}

void add_to(Plane& sum, const PlaneMoments& m) {
  const auto total = [](const std::array<double, kLanes>& v) {
    return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
  };
  sum = {sum.c + total(m.c), sum.x + total(m.x), sum.y + total(m.y)};
}

/// The quantities of n pixels whose moments are taken: o0 to o3 for the slopes, each where it rules, of for
/// the factor and p0 to p2 for the weights. S: the number of slopes; quantities of those missing are not set.
template <int S, bool Walls, bool Factor>
[[gnu::always_inline]] inline void fill_quantities(const Shape& s, std::size_t n, const double* __restrict x,
                                                   const double* __restrict y, const double* __restrict q0,
                                                   const double* __restrict q1, const double* __restrict q2,
                                                   double* __restrict o0, double* __restrict o1,
                                                   double* __restrict o2, double* __restrict o3,
                                                   double* __restrict of, double* __restrict p0,
                                                   double* __restrict p1, double* __restrict p2) {
  const Plane s0 = s.slopes[0], s1 = s.slopes[1], s2 = s.slopes[2], s3 = s.slopes[3];
  const Plane a0 = s.walls[0], a1 = s.walls[1], a2 = s.walls[2];
  const Plane w0 = s.weights[0], w1 = s.weights[1], w2 = s.weights[2], wf = s.factor;
  for (std::size_t i = 0; i < n; ++i) {
    const double ux = x[i];
    const double uy = y[i];
    const auto at = [ux, uy](const Plane& p) { return p.c + p.x * ux + p.y * uy; };
    const double v0 = at(s0);
    double v1 = 0, v2 = 0;
    double least = v0;
    if constexpr (S > 1) least = (v1 = at(s1)) < least ? v1 : least;
    if constexpr (S > 2) least = (v2 = at(s2)) < least ? v2 : least;
    if constexpr (S > 3) least = at(s3) < least ? at(s3) : least;
    // Each pixel counts for the slope that rules there; ties go to the first. Products with 0 or 1, because
    // choices that depend on each other keep the compiler from using vectors.
    double positive = least > 0 ? 1.0 : 0.0;
    if constexpr (Walls) {
      const double d0 = at(a0);
      const double d1 = at(a1);
      const double d2 = at(a2);
      const double d01 = d1 < d0 ? d1 : d0;
      const double d = d2 < d01 ? d2 : d01;
      positive *= d > 0 ? 1.0 : 0.0;
    }
    double v = least * positive;
    const double share = at(w0) * q0[i] + at(w1) * q1[i] + at(w2) * q2[i];
    double slope = share * positive;
    if constexpr (Factor) {
      const double f = at(wf);
      of[i] = v * share;
      v *= f;
      slope *= f;
    }
    if constexpr (S > 1) {
      const double rules = v0 <= least ? 1.0 : 0.0;
      o0[i] = slope * rules;
      slope -= slope * rules;
    }
    if constexpr (S > 2) {
      const double rules = v1 <= least ? 1.0 : 0.0;
      o1[i] = slope * rules;
      slope -= slope * rules;
    }
    if constexpr (S > 3) {
      const double rules = v2 <= least ? 1.0 : 0.0;
      o2[i] = slope * rules;
      slope -= slope * rules;
    }
    double* const last = S > 3 ? o3 : S > 2 ? o2 : S > 1 ? o1 : o0;
    last[i] = slope;
    p0[i] = v * q0[i];
    p1[i] = v * q1[i];
    p2[i] = v * q2[i];
  }
}

template <bool Walls, bool Factor>
[[gnu::always_inline]] inline void fill_by_slopes(const Shape& s, std::size_t n, const double* x,
                                                  const double* y, const double* const* q, double* const* o) {
  switch (s.slope_count) {
    case 1:
      return fill_quantities<1, Walls, Factor>(s, n, x, y, q[0], q[1], q[2], o[0], o[1], o[2], o[3], o[4],
                                               o[5], o[6], o[7]);
    case 2:
      return fill_quantities<2, Walls, Factor>(s, n, x, y, q[0], q[1], q[2], o[0], o[1], o[2], o[3], o[4],
                                               o[5], o[6], o[7]);
    case 3:
      return fill_quantities<3, Walls, Factor>(s, n, x, y, q[0], q[1], q[2], o[0], o[1], o[2], o[3], o[4],
                                               o[5], o[6], o[7]);
    default:
      return fill_quantities<4, Walls, Factor>(s, n, x, y, q[0], q[1], q[2], o[0], o[1], o[2], o[3], o[4],
                                               o[5], o[6], o[7]);
  }
}

[[gnu::always_inline]] inline void add_moments(std::size_t n, const double* __restrict x,
                                               const double* __restrict y, const double* __restrict o,
                                               PlaneMoments& moments) {
  PlaneMoments sum = moments;
  for (std::size_t i = 0; i < n; i += kLanes) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      sum.c[l] += o[i + l];
      sum.x[l] += o[i + l] * x[i + l];
      sum.y[l] += o[i + l] * y[i + l];
    }
  }
  moments = sum;
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

void add_to(ShapeGradient& gradient, const ShapeMoments& moments) {
  for (std::size_t i = 0; i < 4; ++i) add_to(gradient.slopes[i], moments.slopes[i]);
  add_to(gradient.factor, moments.factor);
  for (std::size_t i = 0; i < 3; ++i) add_to(gradient.weights[i], moments.weights[i]);
}

double change(const ShapeGradient& g, const Shape& from, const Shape& to) {
  double sum = dot(to.factor - from.factor, g.factor);
  for (std::size_t i = 0; i < 4; ++i) sum += dot(to.slopes[i] - from.slopes[i], g.slopes[i]);
  for (std::size_t i = 0; i < 3; ++i) sum += dot(to.weights[i] - from.weights[i], g.weights[i]);
  return sum;
}

KNOTREEL_MULTIVERSION
void add_pixels(const Shape& s, std::size_t n, const double* x, const double* y, const double* const* q,
                double* const* o, ShapeMoments& moments) {
  if (s.has_factor) {
    fill_by_slopes<true, true>(s, n, x, y, q, o);
    add_moments(n, x, y, o[4], moments.factor);
  } else if (s.wall_count > 0) {
    fill_by_slopes<true, false>(s, n, x, y, q, o);
  } else {
    fill_by_slopes<false, false>(s, n, x, y, q, o);
  }
  for (std::size_t k = 0; k < s.slope_count; ++k) add_moments(n, x, y, o[k], moments.slopes[k]);
  for (std::size_t k = 0; k < 3; ++k) add_moments(n, x, y, o[5 + k], moments.weights[k]);
}

}  // namespace knotreel::fit
