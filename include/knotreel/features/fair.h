// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/features/chains.h"

namespace knotreel::features {

struct FairOptions {
  double lambda = 0.5;      ///< share of the neighbours, 0..1
  int iterations = 3;       ///< >= 0
  bool keep_size = true;    ///< each step is followed by one back [Taubin95], so that curves do not shrink
  double max_shift = 0.05;  ///< px, > 0: no point goes further from where it was
  double max_shift_of_steps = 0.3;  ///< the same, for chains that are stepped

  bool operator==(const FairOptions&) const = default;
};

/// Smooths the curves by p_i <- (1 - lambda) p_i + lambda/4 (p_{i-2} + p_{i-1} + p_{i+1} + p_{i+2}) (paper
/// Eq. 5), cyclic for closed chains. Nodes stay; points next to them use their two neighbours only. No point
/// leaves the square of one pixel around its pixel's centre, so corners are rounded by no more than that.
/// Where curves would cross or touch afterwards, points go back to where they came from.
///
/// The paper takes one step without `keep_size`, from pixel centres. Detected positions are better than that:
/// steps alone would move a circle of radius 10 inwards by 0.09 px each, from an error of 0.03 px. So points
/// stay within `max_shift` (decision 33): what is further off is a corner, or the end of a stroke. Edges
/// without antialiasing come in steps of a pixel, whose places say less (decision 36).
/// @throws Error{kInvalidArgument} for options out of range.
/// Linear time. Safe to call from several threads on different chains.
void fair_chains(FeatureChains& chains, const FairOptions& options = {});

}  // namespace knotreel::features
