#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/spline/basis.h"

namespace knotreel::fit {

/// Finds where the map of a geometry is about to fold, at samples on both sides of all features, where it
/// bends most; again and again while displacements change. Not thread safe; works on all threads allowed.
class Folds {
 public:
  /// @param displacement by geometry group, pixels. @param basis must outlive this.
  Folds(const spline::Basis& basis, std::span<const Vec2> displacement);

  /// @param least_area that the map may leave of a unit of area. @return how many samples have less.
  std::size_t find(double least_area);

  /// By geometry group: 1 for those that move samples found by the last find().
  std::vector<std::uint8_t> groups() const;

  /// Displacements are others now. @param changed by group: 1 for those that are.
  void change(std::span<const Vec2> displacement, const std::vector<std::uint8_t>& changed);

 private:
  static constexpr std::size_t kSamples = 64;
  using Values = std::array<float, kSamples>;

  /// Samples that lie together, with the terms that may move them: made for vectors.
  struct Batch {
    std::vector<Vec2> places;
    std::vector<spline::TermIndex::Entry> terms;
    std::uint64_t folded = 0;  ///< a bit per sample
    bool is_known = false;
  };

  /// What a piece multiplies its terms by: displacements, which are linear there.
  struct Motion {
    Vec2 at_zero;
    Vec2 by_x;
    Vec2 by_y;
    bool any = false;
  };

  void add_batches(const mesh::FeatureSegment& segment);
  void add_terms(std::span<Batch> batches) const;
  Motion motion_of(const spline::Piece& piece, std::span<const Vec2> displacement) const;
  Values areas(const Batch& batch) const;

  const spline::Basis& basis_;
  std::vector<Motion> motions_;  ///< by piece
  std::vector<Batch> batches_;
};

}  // namespace knotreel::fit
