// SPDX-License-Identifier: GPL-3.0-or-later
#include "spline/tile_terms.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "base/multiversion.h"
#include "spline/tent.h"

namespace knotreel::spline {

namespace {

template <class Value>
using Values = std::array<Value, kPixels>;

/// S: number of slopes, 0 for the constant tents of degree 1. Inlined into each version of add_term().
template <int S, bool Walls, bool Factor, class Value>
[[gnu::always_inline]] inline void term_loop(const PieceTerm& term, Vec2 origin, const Value* __restrict x,
                                             const Value* __restrict y, Value* __restrict out) {
  using Plane = PlaneIn<Value>;
  const auto plane = [origin](const Affine& a) {
    return Plane{static_cast<Value>(a(origin)), static_cast<Value>(a.nx), static_cast<Value>(a.ny)};
  };
  const std::array<Affine, 4>& slopes = term.tent.slopes;
  Plane s0, s1, s2, s3;
  if constexpr (S > 0) s0 = plane(slopes[0]);
  if constexpr (S > 1) s1 = plane(slopes[1]);
  if constexpr (S > 2) s2 = plane(slopes[2]);
  if constexpr (S > 3) s3 = plane(slopes[3]);
  std::array<Plane, 3> walls{Plane{1, 0, 0}, Plane{1, 0, 0}, Plane{1, 0, 0}};  // those missing: far away
  if constexpr (Walls) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(term.tent.wall_count); ++i)
      walls[i] = plane(term.tent.walls[i]);
  }
  const Plane a0 = walls[0], a1 = walls[1], a2 = walls[2];
  const auto constant = static_cast<Value>(term.tent.constant);
  const Plane factor = Factor ? plane(term.factor) : Plane{};
  for (std::size_t i = 0; i < kPixels; ++i) {
    const Value ux = x[i];
    const Value uy = y[i];
    const auto at = [ux, uy](const Plane& p) { return p.c + p.x * ux + p.y * uy; };
    Value v = constant;
    if constexpr (S > 0) v = at(s0);
    if constexpr (S > 1) v = at(s1) < v ? at(s1) : v;
    if constexpr (S > 2) v = at(s2) < v ? at(s2) : v;
    if constexpr (S > 3) v = at(s3) < v ? at(s3) : v;
    v = v > 0 ? v : 0;
    if constexpr (Walls) {
      const Value d01 = at(a1) < at(a0) ? at(a1) : at(a0);
      const Value d = at(a2) < d01 ? at(a2) : d01;
      v = d > 0 ? v : 0;
    }
    if constexpr (Factor) v *= at(factor);
    out[i] = v;
  }
}

template <bool Walls, bool Factor, class Value>
[[gnu::always_inline]] inline void term_by_slopes(const PieceTerm& term, Vec2 origin, const Value* x,
                                                  const Value* y, Value* out) {
  switch (term.tent.slope_count) {
    case 0:
      return term_loop<0, Walls, Factor>(term, origin, x, y, out);
    case 1:
      return term_loop<1, Walls, Factor>(term, origin, x, y, out);
    case 2:
      return term_loop<2, Walls, Factor>(term, origin, x, y, out);
    case 3:
      return term_loop<3, Walls, Factor>(term, origin, x, y, out);
    default:
      return term_loop<4, Walls, Factor>(term, origin, x, y, out);
  }
}

template <class Value>
[[gnu::always_inline]] inline void term_by_parts(const PieceTerm& term, Vec2 origin, const Value* x,
                                                 const Value* y, Value* out) {
  if (term.has_factor) {
    if (term.tent.wall_count > 0) return term_by_slopes<true, true>(term, origin, x, y, out);
    return term_by_slopes<false, true>(term, origin, x, y, out);
  }
  if (term.tent.wall_count > 0) return term_by_slopes<true, false>(term, origin, x, y, out);
  return term_by_slopes<false, false>(term, origin, x, y, out);
}

template <class Value>
[[gnu::always_inline]] inline void add_shares(const Value* __restrict term, const Value* __restrict x,
                                              const Value* __restrict y, std::span<const Share<Value>> shares,
                                              bool clamp) {
  for (const Share<Value>& share : shares) {
    const PlaneIn<Value> p = share.plane;
    Value* __restrict sums = share.sums;
    if (clamp) {
      for (std::size_t i = 0; i < kPixels; ++i) {
        const Value v = p.c + p.x * x[i] + p.y * y[i];
        sums[i] += term[i] * (v > 0 ? v : 0);
      }
    } else {
      for (std::size_t i = 0; i < kPixels; ++i) sums[i] += term[i] * (p.c + p.x * x[i] + p.y * y[i]);
    }
  }
}

template <class Value>
[[gnu::always_inline]] inline void add_in(const PieceTerm& term, Vec2 origin, const Value* places,
                                          std::span<const Share<Value>> shares, bool clamp) {
  alignas(64) Values<Value> values;
  term_by_parts(term, origin, places, places + kPixels, values.data());
  add_shares(values.data(), places, places + kPixels, shares, clamp);
}

/// Of a term none of whose walls has a pixel on it.
KNOTREEL_MULTIVERSION
void add_term(const PieceTerm& term, Vec2 origin, const double* places, std::span<const Share<double>> shares,
              bool clamp) {
  add_in(term, origin, places, shares, clamp);
}
KNOTREEL_MULTIVERSION
void add_term(const PieceTerm& term, Vec2 origin, const float* places, std::span<const Share<float>> shares,
              bool clamp) {
  add_in(term, origin, places, shares, clamp);
}

/// Distance of a wall, pixels, from which on the precision tells on which side a point is.
template <class Value>
constexpr auto kClearOfWall = static_cast<Value>(std::is_same_v<Value, double> ? 2 * kOnWall : 1e-4);

template <class Value>
[[gnu::always_inline]] inline bool on_wall_in(const Tent& tent, Vec2 origin, const Value* __restrict x,
                                              const Value* __restrict y) {
  constexpr std::size_t kLanes = 8;
  for (std::size_t w = 0; w < static_cast<std::size_t>(tent.wall_count); ++w) {
    const PlaneIn<Value> wall = plane_in<Value>(plane_of(tent.walls[w], origin));
    std::array<Value, kLanes> nearest;
    nearest.fill(std::numeric_limits<Value>::max());
    for (std::size_t i = 0; i < kPixels; i += kLanes) {
      for (std::size_t l = 0; l < kLanes; ++l) {
        const Value d = std::abs(wall.c + wall.x * x[i + l] + wall.y * y[i + l]);
        nearest[l] = d < nearest[l] ? d : nearest[l];
      }
    }
    if (*std::min_element(nearest.begin(), nearest.end()) <= kClearOfWall<Value>) return true;
  }
  return false;
}

/// Whether some pixel is nearer to a wall of a tent that has some.
KNOTREEL_MULTIVERSION
bool any_on_wall(const Tent& tent, Vec2 origin, const double* places) {
  return on_wall_in(tent, origin, places, places + kPixels);
}
KNOTREEL_MULTIVERSION
bool any_on_wall(const Tent& tent, Vec2 origin, const float* places) {
  return on_wall_in(tent, origin, places, places + kPixels);
}

}  // namespace

template <class Value>
TilePlaces<Value>::TilePlaces(const PixelTiles& tiles, std::size_t tile)
    : tiles_(tiles), tile_(tile), origin_(tiles.corner(tile)) {
  if constexpr (std::is_same_v<Value, float>) {
    x_ = tiles.places(tile).data();
  } else {
    x_ = exact();
  }
}

template <class Value>
TilePlaces<Value>::TilePlaces(const PixelTiles& tiles, std::size_t tile,
                              std::span<const Vec2, kPixels> places)
    : tiles_(tiles), tile_(tile), origin_(tiles.corner(tile)), x_(other_.data()), has_exact_(true) {
  for (std::size_t i = 0; i < kPixels; ++i) {
    exact_[i] = places[i].x - origin_.x;
    exact_[kPixels + i] = places[i].y - origin_.y;
  }
  std::transform(exact_.begin(), exact_.end(), other_.begin(),
                 [](double v) { return static_cast<Value>(v); });
}

template <class Value>
const double* TilePlaces<Value>::exact() {
  if (!has_exact_) tiles_.places(tile_, exact_.data(), exact_.data() + kPixels);
  has_exact_ = true;
  return exact_.data();
}

template <class Value>
void TilePlaces<Value>::add(const PieceSet& set, const Piece& piece, std::span<const Share<Value>> shares,
                            bool clamp) {
  for (std::uint32_t t = piece.term_begin; t < piece.term_end; ++t) {
    const PieceTerm& term = set.terms[t];
    if (term.tent.wall_count > 0 && any_on_wall(term.tent, origin_, x_)) {
      add_one_by_one(term, shares, clamp);
    } else {
      add_term(term, origin_, x_, shares, clamp);
    }
  }
}

template <class Value>
void TilePlaces<Value>::add_one_by_one(const PieceTerm& term, std::span<const Share<Value>> shares,
                                       bool clamp) {
  const mesh::KnotMesh& mesh = tiles_.basis().space().mesh();
  const double* const x = exact();
  const double* const y = x + kPixels;
  Values<Value> values;
  for (std::size_t i = 0; i < kPixels; ++i) {
    const Vec2 u = origin_ + Vec2{x[i], y[i]};
    const double v = tent_value(term.tent, u, inward_direction(u, mesh.width, mesh.height));
    values[i] = static_cast<Value>(term.has_factor ? v * term.factor(u) : v);
  }
  add_shares(values.data(), x_, x_ + kPixels, shares, clamp);
}

template class TilePlaces<double>;
template class TilePlaces<float>;

}  // namespace knotreel::spline
