// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "knotreel/fit/colour_fit.h"
#include "knotreel/track/motion.h"
#include "knotreel/track/tracker.h"
#include "track/fitted_frame.h"
#include "track/laps.h"

namespace knotreel::track {

/// What a warm frame is fitted to, and how.
struct WarmFit {
  const image::Image& picture;
  const Motion& motion;                  ///< from the frame before
  std::span<const std::uint32_t> match;  ///< of the functions with those of the frame before
  const fit::ColourFitOptions& colour;
  const TrackOptions& options;
  double mixed_weight = 0;  ///< as vectorize::Options
};

/// Finds the places of the pixels and the colours of a frame whose space, displacement, basis, softness and
/// step of colours are known; what is as it was in the frame before is taken from there.
void fit_warm_frame(const FittedFrame& before, const WarmFit& how, FittedFrame& frame, Laps& laps);

}  // namespace knotreel::track
