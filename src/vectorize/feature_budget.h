// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/features/chains.h"
#include "knotreel/image/image.h"
#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::vectorize {

/// Control points per pixel of features, about (counted over photographs).
inline constexpr double kFunctionsPerFeaturePixel = 0.5;

/// Control points of a space over a mesh, before it is built: about (counted over photographs).
double expected_functions(const mesh::EditableMesh& mesh, int degree);

/// Control points that features will cost, before they are parametrized: about.
double expected_functions(const features::FeatureChains& chains);

/// Mean over the points of a chain of the largest range of a channel within some pixels, levels.
/// @param scale pixels of the chain per pixel of the picture.
double mean_range(const image::Image& picture, const features::Chain& chain, int radius, int scale = 1);

/// Drops feature chains that turn by more radians per pixel, in the mean.
/// @return those that were dropped.
features::FeatureChains drop_winding(double max_turning, features::FeatureChains& chains);

/// Of the control points, for features; 0 to 1.
struct FeatureShares {
  double any = 0.6;
  double weak = 0.1;  ///< above which weak ones go
};

/// What was left out for the sake of a budget.
struct DroppedFeatures {
  bool strong = false;  ///< the share of any was not enough, so that strong ones were dropped, too
  double points = 0;    ///< of their chains
  double contrast = 0;  ///< levels, summed over these points

  double mean_contrast() const { return points > 0 ? contrast / points : 0; }
  void add(const DroppedFeatures& more);
};

/// Drops feature chains that cost more control points than features may use up, before any knot is put
/// between them: those of least contrast for what they cost, weak ones first, which the smooth surface can
/// stand in for.
/// @param picture of the size of the chains, or half as wide and high.
/// @param functions that the chains cost together. @param most control points of the whole model.
DroppedFeatures keep_within_budget(const image::Image& picture, double functions, double most,
                                   const FeatureShares& shares, features::FeatureChains& chains);

}  // namespace knotreel::vectorize
