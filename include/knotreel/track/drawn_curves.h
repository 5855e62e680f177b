#pragma once

#include <memory>

#include "knotreel/image/image.h"
#include "knotreel/vectorize/options.h"

namespace knotreel::track {

/// The curves of the features of a drawing, found in its picture alone. Opaque.
struct DrawnCurves;

/// A good part of the work of a frame whose features are found anew (docs/decisions/0040). It needs nothing
/// of other frames, so it may be done ahead of Tracker::next(), for several frames at once.
/// @param drawn TrackOptions::drawn. @return null if the picture is no drawing (features::is_drawing()).
/// @throws Error{kInvalidArgument} as vectorize_picture().
std::shared_ptr<const DrawnCurves> find_drawn_curves(const image::Image& picture,
                                                     const vectorize::Options& drawn);

}  // namespace knotreel::track
