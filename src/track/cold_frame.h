// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "knotreel/track/cold_frame.h"
#include "track/fitted_frame.h"

namespace knotreel::track {

/// Film below that leaves small text illegible; dB.
inline constexpr double kLegible = 35;

struct ColdFrame {
  FittedFrame frame;
  bool features_dropped = false;                             ///< as vectorize::Report
  std::vector<std::pair<std::string, double>> milliseconds;  ///< per stage, in order
};

/// Control points of a frame of film: more, up to as many as dense film may have, where captions ask for
/// them.
/// @param dense_film null: no more.
std::size_t most_for_film(const image::Image& picture, const vectorize::Options& film,
                          const vectorize::Options* dense_film);

/// Of a drawing in a group of drawings: as film it was tried in the first frame. It is as the group is,
/// unless it would be poor for want of control points and is better on the plain grid, or densely.
std::shared_ptr<ColdFrame> make_drawn_frame(const image::Image& picture, const ColdOptions& options,
                                            const FittedFrame& group, double colour_step);

}  // namespace knotreel::track
