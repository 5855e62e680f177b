// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/spline/basis.h"

namespace knotreel::fit {

/// Finds where the map of a geometry is about to fold, at samples on both sides of all features, where it
/// bends most; again and again while displacements shrink. Not thread safe; works on all threads allowed.
class Folds {
 public:
  /// @param displacement by geometry group, pixels. @param basis must outlive this.
  Folds(const spline::Basis& basis, std::span<const Vec2> displacement);

  /// @param least_area that the map may leave of a unit of area. @return how many samples have less.
  std::size_t find(double least_area);

  /// By geometry group: 1 for those that move samples found by the last find().
  std::vector<std::uint8_t> groups() const;

  /// The displacements of some groups times a factor.
  /// @param shrinking by group: 1 for these.
  void shrink(const std::vector<std::uint8_t>& shrinking, double factor);

  const std::vector<Vec2>& displacement() const { return displacement_; }

 private:
  static constexpr std::size_t kSamples = 64;

  /// Derivatives of the displacement at samples.
  struct Derivatives {
    alignas(64) std::array<float, kSamples> xx{};  ///< of x by x
    alignas(64) std::array<float, kSamples> xy{};  ///< of x by y
    alignas(64) std::array<float, kSamples> yx{};
    alignas(64) std::array<float, kSamples> yy{};

    void scale(float factor);
    void add(const Derivatives& other, float factor);
  };

  /// Samples that lie together, with the terms that may move them: made for vectors.
  struct Batch {
    std::vector<Vec2> places;
    std::vector<spline::TermIndex::Entry> terms;
    Derivatives all;
    std::vector<std::uint32_t> shrinking;  ///< groups, which will mostly shrink once more ...
    Derivatives part;                      ///< ... and so will this, which they add to `all`
    std::uint64_t folded = 0;              ///< a bit per sample
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
  void add_terms(std::span<Batch> batches, const std::vector<Motion>& motions) const;
  void name_groups();
  /// @param chosen by group: whether it counts. None: all do.
  Motion motion_of(const spline::Piece& piece, std::span<const std::uint8_t> chosen = {}) const;
  /// @param motion_of by piece.
  template <class MotionOf>
  Derivatives derivatives(const Batch& batch, const MotionOf& motion_of) const;
  void shrink(Batch& batch, std::vector<std::uint32_t> groups, std::span<const std::uint8_t> shrinking,
              double factor) const;

  const spline::Basis& basis_;
  std::vector<Vec2> displacement_;
  std::vector<Batch> batches_;
  std::vector<std::vector<std::uint32_t>> reached_;  ///< by group: batches; none until something shrinks
};

}  // namespace knotreel::fit
