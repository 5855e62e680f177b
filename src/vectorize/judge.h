// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/vectorize/options.h"
#include "vectorize/draft.h"
#include "vectorize/run_log.h"
#include "vectorize/samples.h"

namespace knotreel::vectorize {

/// What of the thresholds is missed.
struct Missed {
  bool means = false;
  std::vector<float> blocks;  ///< else: squared errors in blocks above the bound, 0 elsewhere; empty: none is
};

/// Tells after each round whether another one is needed, and where.
class Judge {
 public:
  /// All outlive this. @param of_picture if the samples are of a fine grid, those of the picture, or null.
  Judge(const Options& options, Samples& samples, Samples* of_picture, RunLog& log, Draft& draft)
      : options_(options), samples_(samples), of_picture_(of_picture), log_(log), draft_(draft) {}

  Missed missed();

 private:
  bool means_met() const;
  Missed missed_as_fitted();
  Missed missed_as_drawn();
  Missed missed_in_picture();
  Missed worst_blocks(std::vector<float> errors, const image::Image& picture) const;

  const Options& options_;
  Samples& samples_;
  Samples* of_picture_;
  RunLog& log_;
  Draft& draft_;
  std::vector<std::uint8_t> good_;  // pixels of blocks that will be drawn well enough; empty: not known
};

}  // namespace knotreel::vectorize
