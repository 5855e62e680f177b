// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include "spline/plane.h"

/// Derivatives of sums over pixels by the planes that the terms of a piece are made of (docs/algorithm.md,
/// "descent on the true residual").
namespace knotreel::fit {

using spline::Plane;

/// One term of a piece: min of the slopes, inside the walls, times the factor, times the three weights.
struct Shape {
  std::array<Plane, 4> slopes{};
  std::array<Plane, 3> walls{Plane{1, 0, 0}, Plane{1, 0, 0}, Plane{1, 0, 0}};  ///< those missing: far away
  Plane factor{1, 0, 0};
  std::array<Plane, 3> weights{};
  std::size_t slope_count = 0;  ///< at least 1: the constant of degree 1 is a level slope
  std::size_t wall_count = 0;
  bool has_factor = false;
};

/// @param origin of the planes' coordinates.
Shape shape_of(const spline::Piece& piece, const spline::PieceTerm& term, Vec2 origin);

/// Derivative of sum over pixels of (q_0 w_0 + q_1 w_1 + q_2 w_2) * factor * min of slopes by the
/// coefficients of each of its planes: of the four slopes, the factor and the three weights, in this order.
struct ShapeGradient {
  static constexpr std::size_t kFactor = 4;
  static constexpr std::size_t kWeights = 5;
  static constexpr std::size_t kPlanes = 8;
  std::array<double, kPlanes> c{};
  std::array<double, kPlanes> x{};
  std::array<double, kPlanes> y{};
};

void add_to(ShapeGradient& sum, const ShapeGradient& gradient);

/// How the sum changes when the planes change like this.
double change(const ShapeGradient& g, const Shape& from, const Shape& to);

/// Adds how the sum changes when everything moves, with the pixels left where they are: by a constant, by x
/// and by y times a small step along either axis, which are the components of each vector.
void add_affine(const Shape& s, const ShapeGradient& g, std::array<Vec2, 3>& sum);

/// Adds the pixels of a tile, in single precision. @param x, y of the pixels, relative to the origin of the
/// shape. @param q residual times control point, of each of the three functions. @param offset of the origin
/// of the shape from that of the gradient.
void add_pixels(const Shape& s, const float* x, const float* y, const float* const* q, Vec2 offset,
                ShapeGradient& gradient);

}  // namespace knotreel::fit
