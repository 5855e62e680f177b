// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "raster/surface.h"

/// The inner loops of the renderer: everything about n points of one tile, in plain loops that the compiler
/// turns into vector instructions. Arrays of points are parallel; n <= kBatch.
namespace knotreel::raster {

/// Most points that a tile handles at once.
inline constexpr int kBatch = 256;

/// The one-sided direction of all points of a tile; see spline::inward_direction.
inline constexpr Vec2 kDirection = {0.8191520442889918, 0.5735764363510462};

/// A quadratic polynomial around some centre.
struct Quadratic {
  double c, x, y, xx, xy, yy;
};

/// Displacement and its Jacobian at the points of a batch.
struct GeometryBatch {
  alignas(64) std::array<double, kBatch> d[2];
  alignas(64) std::array<double, kBatch> j[2][2];
};

void set_geometry(const Quadratic& q, Vec2 centre, const double* ux, const double* uy, int n, double* value,
                  double* gx, double* gy);
void add_geometry(const SurfaceTerm& term, const double* ux, const double* uy, int n, GeometryBatch& g);

/// Colours of channel c at out[c * kBatch + i].
void set_colour(const Quadratic& q, Vec2 centre, const double* ux, const double* uy, int n, double* out);
void add_colours(const SurfaceTerm& term, std::size_t channels, const double* ux, const double* uy, int n,
                 double* out);

/// Quadratic interpolation at n points of nine values at the nodes of a 3 x 3 lattice over the box.
void interpolate(const std::array<double, 9>& node, Vec2 low, Vec2 size, const double* x, const double* y,
                 int n, double* out);

/// One Newton step towards S_geo(u) = (x, y), clamped to [low, high]; the lengths go into `moved`.
/// @return the longest of them.
double newton_step(const GeometryBatch& g, const double* x, const double* y, int n, Vec2 low, Vec2 high,
                   double* ux, double* uy, double* moved);

}  // namespace knotreel::raster
