// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/spline/piece.h"
#include "knotreel/spline/reference.h"
#include "knotreel/spline/space.h"

/// Evaluation of all basis functions by the generalised de Boor step (docs/algorithm.md): each config of
/// Gamma_{k-1} adds its three barycentric shares of one simplex spline of degree k-1.
namespace knotreel::spline {

/// Cells over the domain with the terms of pieces whose bounding boxes touch them.
class TermIndex {
 public:
  struct Entry {
    std::uint32_t term;
    std::uint32_t piece;
  };

  TermIndex() = default;
  /// @param width, height of the domain, in pixels. @param knots of the mesh: there are about as many cells.
  TermIndex(const PieceSet& set, double width, double height, std::size_t knots);

  /// Terms that may be non-zero at u (which is clamped to the domain), ascending.
  std::span<const Entry> at(Vec2 u) const;

  /// Whether u is in the bounding box of a term, or as near to it as a point on a wall may be.
  bool near(const Entry& entry, Vec2 u) const {
    const auto& [low, high] = boxes_[entry.term];
    return low.x <= u.x && u.x <= high.x && low.y <= u.y && u.y <= high.y;
  }

  /// Appends the terms that may be non-zero somewhere in the box, ascending, each once.
  void in_box(Vec2 low, Vec2 high, std::vector<Entry>& out) const;

  /// The box, low and high, outside which a term counts as zero.
  const std::pair<Vec2, Vec2>& box(std::uint32_t term) const { return boxes_[term]; }

  /// Terms of all cells together: at most 64 per term.
  std::size_t entry_count() const { return entries_.size(); }

 private:
  void set_cell(double cell, double width, double height);
  /// Terms of all cells together, if the cells are as they are now.
  double entries_needed() const;
  std::size_t column(double x) const;
  std::size_t row(double y) const;

  double cell_ = 1;
  std::size_t columns_ = 1;
  std::size_t rows_ = 1;
  std::vector<std::size_t> begin_;
  std::vector<Entry> entries_;
  std::vector<std::pair<Vec2, Vec2>> boxes_;
};

struct BasisValue {
  FunctionIndex function;
  double value;
};

struct BasisJet {
  FunctionIndex function;
  Jet jet;
};

/// Basis functions of many points: functions of point i at [begin[i], begin[i+1]).
struct ScatteredValues {
  std::vector<std::size_t> begin;
  std::vector<BasisValue> values;
};

/// Ready to evaluate one space at any points of the closed domain. Immutable and thread safe.
/// Values agree with ReferenceBasis to 1e-10; they sum to 1 and are not negative, both up to rounding.
class Basis {
 public:
  /// @throws Error{kInvalidArgument} if there is none.
  explicit Basis(std::shared_ptr<const SplineSpace> space);

  const SplineSpace& space() const { return *space_; }
  const PieceSet& pieces() const { return pieces_; }
  /// Made when it is first asked for: the values at pixels do without it.
  const TermIndex& index() const;

  /// Functions that are not zero at u, ascending; none outside the domain. On a feature (and wherever else a
  /// side must be chosen) the limit from the side of `direction`; the shorter form uses inward_direction(u).
  void evaluate(Vec2 u, Vec2 direction, std::vector<BasisValue>& out) const;
  void evaluate(Vec2 u, std::vector<BasisValue>& out) const;

  /// The same with first and second derivatives, all of them limits from the side of `direction`.
  void evaluate(Vec2 u, Vec2 direction, std::vector<BasisJet>& out) const;

  /// Many points at once, on all threads allowed; the result does not depend on their number.
  ScatteredValues evaluate(std::span<const Vec2> points) const;

 private:
  struct LazyIndex {
    std::once_flag made;
    TermIndex index;
  };

  std::shared_ptr<const SplineSpace> space_;
  PieceSet pieces_;
  std::unique_ptr<LazyIndex> index_ = std::make_unique<LazyIndex>();
};

}  // namespace knotreel::spline
