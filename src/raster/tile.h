// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "raster/kernels.h"
#include "raster/surface.h"

namespace knotreel::raster {

/// The part of a surface that matters for a small box of the image. What is one polynomial over the whole box
/// is added up beforehand (degree 1 and 2), so that few terms are left for each point; all points of a batch
/// take the same path, which is what vector instructions want. One object per thread; set_block(), set() and
/// then colours() any number of times.
class Tile {
 public:
  explicit Tile(const Surface& surface) : surface_(surface) {}

  /// Prepares for boxes in [low, high] of the image, so that they share a look-up of terms. What is computed
  /// does not depend on it.
  void set_block(Vec2 low, Vec2 high);

  /// Prepares for image points in [low, high], a box of the block. Nine of them are solved for first: that
  /// gives the many that follow a start so close that one Newton step is enough, and a smaller parametric
  /// box.
  void set(Vec2 low, Vec2 high);

  /// Colours at n <= kBatch image points in the box: out[c * kBatch + i].
  void colours(const double* x, const double* y, int n, double* out);

  /// The parameters of n <= kBatch image points in the box.
  void places(const double* x, const double* y, int n, Vec2* out);

 private:
  struct Box {
    Vec2 low;
    Vec2 high;

    /// Without branches: which of the four tests fails cannot be foreseen.
    bool touches(const Box& other) const {
      const bool x = (low.x <= other.high.x) & (high.x >= other.low.x);
      const bool y = (low.y <= other.high.y) & (high.y >= other.low.y);
      return x & y;
    }
  };
  /// A term and the box outside which it is zero.
  struct BoxedTerm {
    Box box;
    const SurfaceTerm* term;
  };

  Box reach_of(const Surface::Bounds& displacement, Vec2 low, Vec2 high) const;
  std::span<const BoxedTerm> terms_of_points(int n);
  void assemble(const Box& box);
  bool fold(const SurfaceTerm& term);
  static bool vanishes(const BoxedTerm& t, const Box& box);
  void solve_nodes(Vec2 low, Vec2 high);
  void start_points(const double* x, const double* y, int n);
  bool invert(const double* x, const double* y, int n, double small);
  /// The same, and if box_ is too small with all terms of the tile. @return whether it was not.
  bool invert_or_reach(const double* x, const double* y, int n, double small);

  const Surface& surface_;
  Box reach_{};  ///< contains every parameter whose image is in the box, by the convex hull property
  Box box_{};    ///< for which terms_ and smooth_ are complete: reach_, or the smaller box around the nodes
  Vec2 centre_;  ///< of box_
  Vec2 shift_;   ///< first guess of u - x without nodes
  bool identity_ = true;
  bool has_kink_ = false;  ///< some term has a wall in box_: the map may have a kink there
  bool has_nodes_ = false;
  Vec2 node_low_;
  Vec2 node_size_;
  std::array<double, 9> node_u_[2];               ///< parameters of the 3 x 3 nodes
  std::array<Quadratic, kMaxChannels> smooth_{};  ///< around centre_
  std::vector<BoxedTerm> block_;                  ///< terms that touch the reach of the block, in order
  std::vector<BoxedTerm> all_;                    ///< those that touch reach_
  std::vector<BoxedTerm> terms_;                  ///< those that are neither zero nor folded into smooth_
  std::vector<BoxedTerm> near_;                   ///< those that some point of a batch may meet
  std::vector<spline::TermIndex::Entry> entries_;
  alignas(64) std::array<double, kBatch> ux_{};
  alignas(64) std::array<double, kBatch> uy_{};
};

/// Solves S_geo(u) = x for one point, from several starts with damped Newton steps; where the surface does
/// not reach x (just outside its border), the nearest u found.
Vec2 solve_point(const Surface& surface, Vec2 x);

}  // namespace knotreel::raster
