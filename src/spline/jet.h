// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "spline/tent.h"

namespace knotreel::spline {

inline Jet affine_jet(const Affine& a, Vec2 u) {
  return {a(u), a.nx, a.ny, 0, 0, 0};
}

inline Jet multiply(const Jet& a, const Jet& b) {
  return {a.value * b.value,
          a.value * b.dx + a.dx * b.value,
          a.value * b.dy + a.dy * b.value,
          a.value * b.dxx + 2 * a.dx * b.dx + a.dxx * b.value,
          a.value * b.dxy + a.dx * b.dy + a.dy * b.dx + a.dxy * b.value,
          a.value * b.dyy + 2 * a.dy * b.dy + a.dyy * b.value};
}

inline void add(Jet& sum, const Jet& a) {
  sum.value += a.value;
  sum.dx += a.dx;
  sum.dy += a.dy;
  sum.dxx += a.dxx;
  sum.dxy += a.dxy;
  sum.dyy += a.dyy;
}

/// Value of a term at u, which may be on a wall; then the side of `direction` counts.
inline double term_value(const PieceTerm& term, Vec2 u, Vec2 direction) {
  const double v = tent_value(term.tent, u, direction);
  return term.has_factor && v != 0 ? v * term.factor(u) : v;
}

/// The same with derivatives.
inline Jet term_jet(const PieceTerm& term, Vec2 u, Vec2 direction) {
  const Jet v = tent_jet(term.tent, u, direction);
  return term.has_factor && v != Jet{} ? multiply(v, affine_jet(term.factor, u)) : v;
}

}  // namespace knotreel::spline
