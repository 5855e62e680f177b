#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "fit/region_moments.h"
#include "knotreel/spline/piece.h"

/// Derivatives of sums over pixels by the planes that the terms of a piece are made of (docs/algorithm.md,
/// "descent on the true residual").
namespace knotreel::fit {

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

/// Pixels that are summed side by side: the order of the sums is fixed, whatever the vector width.
constexpr std::size_t kLanes = 8;

/// Sums over pixels of a quantity, of it times x - ox, and of it times y - oy, by lanes.
struct PlaneMoments {
  std::array<double, kLanes> c{};
  std::array<double, kLanes> x{};
  std::array<double, kLanes> y{};
};

/// Derivative of sum over pixels of (q_0 w_0 + q_1 w_1 + q_2 w_2) * factor * min of slopes by the
/// coefficients of each of its planes.
struct ShapeGradient {
  std::array<Plane, 4> slopes{};
  Plane factor{};
  std::array<Plane, 3> weights{};
};

/// The same while pixels are added, by lanes.
struct ShapeMoments {
  std::array<PlaneMoments, 4> slopes{};
  PlaneMoments factor{};
  std::array<PlaneMoments, 3> weights{};
};

/// Takes over what the lanes have summed up.
void add_to(ShapeGradient& gradient, const ShapeMoments& moments);

/// How the sum changes when the planes change like this.
double change(const ShapeGradient& g, const Shape& from, const Shape& to);

/// Pixels in any order: places relative to the origin, and weighted residuals.
struct PixelBatch {
  std::vector<double> x, y;
  std::array<std::vector<float>, 4> residual;
  /// Residual times control point for each of the three functions.
  std::array<std::vector<double>, 3> q;
  /// Scratch: the quantities whose moments are taken.
  std::array<std::vector<double>, 8> out;

  void clear() {
    x.clear();
    y.clear();
    for (auto& r : residual) r.clear();
  }

  /// Fills up to a multiple of kLanes with pixels without a residual.
  void pad() {
    const std::size_t padded = (x.size() + kLanes - 1) / kLanes * kLanes;
    x.resize(padded);
    y.resize(padded);
    for (auto& r : residual) r.resize(padded);
    for (auto& v : q) v.assign(padded, 0.0);
    for (auto& v : out) v.resize(padded);
  }
};

/// Adds n pixels, a multiple of kLanes, at (x, y). @param q residual times control point, of each of the
/// three functions. @param o room for n values each: eight quantities whose moments are taken.
void add_pixels(const Shape& s, std::size_t n, const double* x, const double* y, const double* const* q,
                double* const* o, ShapeMoments& moments);

}  // namespace knotreel::fit
