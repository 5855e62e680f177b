// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/features/cell_mask.h"
#include "knotreel/features/chains.h"
#include "knotreel/features/corners.h"
#include "knotreel/features/detect.h"
#include "knotreel/features/fair.h"
#include "knotreel/features/known_corners.h"
#include "knotreel/image/image.h"
#include "knotreel/vectorize/options.h"
#include "vectorize/mapped_picture.h"

namespace knotreel::vectorize {

/// All that the curves of a picture hang on besides the picture.
struct CurveRules {
  int scale = 1;
  bool features = true;
  bool fairing = true;
  bool corner_detection = true;
  double max_turning = 0;
  features::DetectOptions detect;
  features::FairOptions fair;
  features::CornerOptions corners;

  bool operator==(const CurveRules&) const = default;
};

/// The curves of a drawing, and what it takes to find those of one that is nearly the same
/// (docs/decisions/0056).
struct KnownCurves {
  image::Image picture;
  CurveRules rules;
  features::CellMask edges;         ///< cells of the grid that have any
  features::FeatureChains winding;  ///< detected, but no features (Options::max_turning)
  Curves curves;
};

/// Nothing is known of pictures of another size.
bool same_size(const image::Image& a, const image::Image& b);

/// All features of a drawing, whether there is room for them or not.
/// @param picture of a drawing, or one behind a drawing (features::may_be_drawing()).
/// @param scale 2: on its fine grid; 1: on its own pixels. @param options in pixels of that grid.
/// @param corners of the pictures before, as also for map_curves().
/// @param known of any other picture, or null: what hangs on the same pixels is taken from there. It does not
/// show.
/// @throws Error{kInvalidArgument} as features::detect_features(). Safe to call from several threads, also
/// with the same known ones.
KnownCurves find_curves(const image::Image& picture, int scale, const Options& options,
                        features::KnownCorners& corners, const KnownCurves* known);

}  // namespace knotreel::vectorize
