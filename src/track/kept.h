// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/fit/pixel_places.h"
#include "track/fitted_frame.h"

namespace knotreel::track {

/// What of a frame is as it was in the one before, so that it need not be found again: screens and drawn
/// pictures are at rest nearly everywhere.
class Kept {
 public:
  /// @param before what came of the frame before. @param frame has a space, a displacement and prints;
  /// nothing is known to be the same unless both have prints. @param match of its functions with those
  /// before. All must outlive this.
  Kept(const FittedFrame& before, const FittedFrame& frame, std::span<const std::uint32_t> match);

  /// Places of pixels where all functions and their displacements are the same.
  fit::KnownPlaces places() const;

  /// Now the frame has been placed: it has what is seen.
  void see();

  /// By function: for how many fits, up to 255, the pixels that it reaches have had the same colours, places
  /// and functions, where the first with other functions or places counts, too: of a picture that has changed
  /// the target still has what was missed before. After see().
  std::vector<std::uint8_t> ages() const;

  /// By tile, whether the surface of control points is the same there, but for rounding; none: nowhere.
  /// After see().
  std::vector<std::uint8_t> surface(std::span<const double> control) const;

 private:
  bool is_known() const { return !functions_.empty(); }
  void find_places();

  const FittedFrame& before_;
  const FittedFrame& frame_;
  std::span<const std::uint32_t> match_;
  std::vector<std::uint8_t> functions_;  ///< that are the same; empty: not known
  std::vector<fit::PlacesOfTile> places_;
  std::vector<std::uint8_t> placing_;  ///< functions that are to be looked at to find places
  std::vector<std::uint8_t> tiles_;    ///< where all functions and places are the same
};

}  // namespace knotreel::track
