// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "param/quad.h"
#include "param/tiles.h"

namespace knotreel::param {

/// The equations of the displacements (screened Tutte, paper sec. 5.2 with docs/decisions/0009): for every
/// free pixel v with its four neighbours n
///
///     sum_n weight_n (d_v - d_n) + d_v / decay^2 = 0
///
/// A neighbour beyond the border stands for the border itself: d = 0 at half the distance, so twice the
/// weight. All other weights are 1. Solved by geometric multigrid with cell aggregates, in the tiles of the
/// grid in which something still changes (docs/decisions/0056).
class ScreenedTutte {
 public:
  /// @param fixed  per pixel, row by row: nonzero where the displacement is given.
  /// @param decay  in pixels; 0: no screening.
  ScreenedTutte(int width, int height, const std::vector<std::uint8_t>& fixed, double decay);

  /// Improves the free pixels of a field until a cycle changes no displacement by more than `tolerance`; what
  /// is left is then a fraction of that. The same bits for any number of threads.
  /// @param changed  pixels whose given displacements are others than when the field was solved last; where a
  /// new field is not zero, all that are given.
  /// @return how many cycles that took.
  int solve(Framed<Quad>& field, double tolerance, std::span<const std::int32_t> changed);

  /// Outside of these the last solve() has changed nothing.
  const Tiles& touched() const { return touched_; }

 private:
  struct Level {
    int width = 0;
    int height = 0;
    Tiles active;
    Framed<float> inverse;  ///< of the diagonal; 0 where fixed
    Framed<float> ground;   ///< part of the diagonal that ties to zero or to fixed pixels
    Framed<float> right;    ///< weight of the edge to the next column
    Framed<float> down;     ///< weight of the edge to the next row
    Framed<Quad> value;     ///< not used on the finest level
    Framed<Quad> rhs;
  };

  static Level coarsen(const Level& fine);
  static void set_inverse(Level& level);
  void activate(Tiles tiles);
  void cycle(Framed<Quad>& field);
  /// `field` is the value of level 0. Changes are noted for that level only.
  void relax(Framed<Quad>& field, std::size_t index, int sweeps);
  void restrict_residual(const Framed<Quad>& field, std::size_t index);
  void prolong(Framed<Quad>& field, std::size_t index);

  int reach_;  ///< of what is given, mostly: tiles; 0: over the whole picture
  std::vector<Level> levels_;
  Tiles touched_;
  std::vector<float> changes_;  ///< by tile of level 0: the largest one of a cycle
};

}  // namespace knotreel::param
