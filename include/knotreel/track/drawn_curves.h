// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>

#include "knotreel/base/error.h"
#include "knotreel/image/image.h"
#include "knotreel/track/known_drawings.h"
#include "knotreel/vectorize/options.h"

namespace knotreel::track {

/// The curves of the features of a drawing, found in its picture alone. Opaque.
struct DrawnCurves;

/// How the features of a frame are found.
enum class Drawing : std::uint8_t {
  kNone,      ///< they are those of the frame before
  kPlain,     ///< in its own picture
  kFineGrid,  ///< there, on a fine grid (vectorize::FineGrid)
};

/// A good part of the work of a frame whose features are found anew (docs/decisions/0040). It needs nothing
/// of other frames, so it may be done ahead of Tracker::next(), for several frames at once.
/// @param drawn TrackOptions::drawn. @param how as Tracker::drawing(), but for kNone.
/// @param known Tracker::known_drawings() or null. Curves keep it.
/// @return null if the picture cannot be one of a sequence of drawings (features::may_be_drawing()).
/// @throws Error{kInvalidArgument} as vectorize_picture().
std::shared_ptr<const DrawnCurves> find_drawn_curves(const image::Image& picture,
                                                     const vectorize::Options& drawn, Drawing how,
                                                     std::shared_ptr<KnownDrawings> known = nullptr);

}  // namespace knotreel::track
