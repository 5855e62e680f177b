// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/spline/space.h"

/// Closed forms of the simplex splines of degree 0, 1 and 2 (docs/algorithm.md, "tents").
namespace knotreel::spline {

/// The affine function n . (u - p), which vanishes at p: differences come first, so that large coordinates
/// cost no precision.
struct Affine {
  double nx = 0;
  double ny = 0;
  double px = 0;
  double py = 0;

  double operator()(Vec2 u) const { return nx * (u.x - px) + ny * (u.y - py); }
};

/// A simplex spline of degree 1 (or the constant of degree 0). On its support, which is convex, a linear
/// simplex spline is the smallest of the linear functions that vanish on the hull edges through two of its
/// knots only; hull edges through three knots, or at a double knot, are walls where it breaks off.
struct Tent {
  std::array<Affine, 4> slopes{};
  std::array<Affine, 3> walls{};  ///< unit normals, positive inside
  int slope_count = 0;
  int wall_count = 0;
  double constant = 0;  ///< the value inside if slope_count is 0
};

/// Distance in pixels below which a point is on a wall and is taken to the side of the given direction.
inline constexpr double kOnWall = 1e-9;

/// Whether u, moved a little along `direction`, is on the inner side of the wall.
inline bool inside_wall(const Affine& wall, Vec2 u, Vec2 direction) {
  const double distance = wall(u);
  if (distance > kOnWall) return true;
  if (distance < -kOnWall) return false;
  return wall.nx * direction.x + wall.ny * direction.y > 0;
}

/// One summand of M_{k-1}(u | T + I): factor * tent; for degree 1 and 2 there is one, with factor 1.
struct PieceTerm {
  Tent tent;
  Affine factor{};
  bool has_factor = false;
  Vec2 low;  ///< bounding box of the support
  Vec2 high;
};

/// One config ready to be evaluated: B_{functions[i]} += weights[i](u) * sum of its terms.
struct Piece {
  std::array<Affine, 3> weights;  ///< area(u, edge of T opposite vertex i)
  std::array<FunctionIndex, 3> functions;
  std::uint32_t term_begin = 0;  ///< PieceSet::terms[term_begin, term_end)
  std::uint32_t term_end = 0;
};

struct PieceSet {
  std::vector<Piece> pieces;  ///< parallel to SplineSpace::configs()
  std::vector<PieceTerm> terms;
};

/// The closed forms of all configs of a space, of any degree. Time and memory are linear in their number.
PieceSet make_pieces(const SplineSpace& space);

/// A knot put elsewhere, close enough to keep all configs and their collinear knots as they are.
struct KnotShift {
  mesh::KnotIndex knot;
  Vec2 position;
};

/// The piece of one config with one knot shifted; its terms are appended. For derivatives by knot positions.
Piece make_shifted_piece(const SplineSpace& space, std::size_t config, const KnotShift& shift,
                         std::vector<PieceTerm>& terms);

}  // namespace knotreel::spline
