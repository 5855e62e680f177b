#pragma once

#include <array>
#include <vector>

#include "raster/surface.h"

namespace knotreel::raster {

/// Most points that a tile handles at once.
inline constexpr int kBatch = 256;

/// The part of a surface that matters for a small box of the image. What is one polynomial over the whole box is
/// added up beforehand (degree 1 and 2), so that few terms are left for each point; all points of a batch take the
/// same path, which is what vector instructions want.
/// One object per thread; set() and then colours() any number of times.
class Tile {
 public:
  explicit Tile(const Surface& surface) : surface_(surface) {}

  /// Prepares for image points in [low, high].
  void set(Vec2 low, Vec2 high);

  /// Colours at n <= kBatch image points in the box: out[c * kBatch + i].
  void colours(const double* x, const double* y, int n, double* out);

 private:
  /// A quadratic polynomial per channel around the centre of the parametric box.
  struct Quadratic {
    double c, x, y, xx, xy, yy;
  };

  bool fold(const SurfaceTerm& term);
  void invert(const double* x, const double* y, int n);

  const Surface& surface_;
  Vec2 low_;   ///< parametric box in which the terms are complete
  Vec2 high_;
  Vec2 centre_;
  Vec2 start_;  ///< first guess of u - x
  bool identity_ = true;
  std::array<Quadratic, kMaxChannels> smooth_{};
  std::vector<const SurfaceTerm*> terms_;
  std::vector<spline::TermIndex::Entry> entries_;
  alignas(64) std::array<double, kBatch> ux_{};
  alignas(64) std::array<double, kBatch> uy_{};
};

/// Solves S_geo(u) = x for one point, from several starts with damped Newton steps; where the surface does not reach
/// x (just outside its border), the nearest u found.
Vec2 solve_point(const Surface& surface, Vec2 x);

}  // namespace knotreel::raster
