// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "knotreel/base/error.h"
#include "knotreel/image/image.h"
#include "knotreel/vectorize/vectorize.h"

namespace knotreel::track {

/// A frame made from its picture alone, with all that the frames after it want to know of it. Opaque.
struct ColdFrame;

/// The ways in which a frame can be made.
struct ColdOptions {
  const vectorize::Options& film;
  const vectorize::Options* drawn = nullptr;       ///< TrackOptions::drawn
  const vectorize::Options* dense = nullptr;       ///< TrackOptions::dense
  const vectorize::Options* dense_film = nullptr;  ///< TrackOptions::dense_film
  const vectorize::Options* cramped = nullptr;     ///< TrackOptions::cramped
};

/// Nearly all the work of a cold frame. It needs nothing of other frames, so it may be done for several
/// frames at once, ahead of Tracker::next(), which takes it over.
/// @param options      of a drawing, it is tried which are better.
/// @param colour_step  TrackOptions::colour_step. @param observer  as for vectorize_picture().
/// @throws Error{kInvalidArgument} as vectorize_picture().
std::shared_ptr<ColdFrame> make_cold_frame(const image::Image& picture, const ColdOptions& options,
                                           double colour_step, const vectorize::Observer& observer = {});

}  // namespace knotreel::track
