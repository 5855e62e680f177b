// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <optional>

#include "knotreel/base/vec2.h"
#include "knotreel/features/chains.h"

namespace knotreel::features {

/// Points of a chain by their steps from one of them, one way.
class ChainWalk {
 public:
  /// @param forward  in the order of the chain, or against it
  ChainWalk(const Chain& chain, std::size_t from, bool forward)
      : chain_(&chain), from_(from), forward_(forward) {}

  /// How many steps there are, at most half of a closed chain.
  std::size_t steps() const {
    const std::size_t n = chain_->points.size();
    if (chain_->closed) return (n - 1) / 2;
    return forward_ ? n - 1 - from_ : from_;
  }
  std::size_t index(std::size_t step) const {
    const std::size_t n = chain_->points.size();
    return (forward_ ? from_ + step : from_ + n - step) % n;
  }
  Vec2 at(std::size_t step) const { return chain_->points[index(step)].position; }

 private:
  const Chain* chain_;
  std::size_t from_;
  bool forward_;
};

/// A straight stretch of a walk.
struct StraightSide {
  std::size_t gap = 0;    ///< steps to its first point
  std::size_t count = 0;  ///< points
  Vec2 point;             ///< their mean
  Vec2 away;              ///< unit vector along them, away from where the walk starts
};

/// The longest straight stretch that begins near the start of a walk, but not at it.
/// @param scale  pixels of the chain per pixel of the picture
std::optional<StraightSide> straight_side(const ChainWalk& walk, double scale);

/// Angle in radians that an arc of a circle would turn by between its ends if they were as straight as these.
double turn_of_arc(const StraightSide& a, const StraightSide& b, double scale);

}  // namespace knotreel::features
