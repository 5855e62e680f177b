// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/features/cell_mask.h"
#include "knotreel/features/chains.h"
#include "knotreel/image/image.h"

namespace knotreel::features {

/// What is a feature. Gradients are those of the smoothed picture, in levels of 0..255 per pixel, of the
/// channel that changes most; colours count by their alpha, and alpha is a channel too.
struct DetectOptions {
  double smoothing = 1.0;        ///< Gaussian sigma before gradients, px; 0..10
  double edge_threshold = 5;     ///< below this gradient nothing is an edge; > 0
  double anchor_threshold = 10;  ///< each chain has a place with at least this gradient (hysteresis)
  double min_length = 16;        ///< points; shorter chains are dropped, but not links of two junctions
  /// Levels. Chains whose gradients, summed over their points, are less are dropped, and links of two
  /// junctions below half of it. So short chains have to be strong, and weak ones long: that is what tells
  /// contours from texture.
  double min_weight = 400;
  double max_blur = 3.5;             ///< px; softer edges are left to the smooth spline; 0: off
  bool euclidean_magnitude = false;  ///< sqrt(Gx^2 + Gy^2) of [Topal12] in place of max(|Gx|, |Gy|)

  bool operator==(const DetectOptions&) const = default;
};

/// Feature curves of a picture by edge drawing ([Topal12], modified as in paper sec. 5.1), cleaned up to the
/// graph that FeatureChains describes, with positions refined to a fraction of a pixel.
///
/// Chains start at the strongest anchors, so where two would touch, the stronger stays. Ends that stop up to
/// three pixels before another chain are joined to it, ends near a side of the picture run on to it; pixels
/// at the sides are only ever ends of chains. The width of an edge, for max_blur, is its contrast (within 4
/// px on either side) over its steepest step: about 2.5 sigma for a step blurred by a Gaussian. Ties go to
/// the smaller row, then column.
/// @param image any size, small ones have no chains
/// @throws Error{kInvalidArgument} for options out of range or a picture whose shape does not fit its
/// samples. Safe to call from several threads; equal input gives equal bits for any thread count.
FeatureChains detect_features(const image::Image& image, const DetectOptions& options = {});

/// Columns and rows of cells: where edges are further apart than that, and only flat cells in between, the
/// features of each are what they would be without the others.
inline constexpr int kEdgesApart = 2;

/// How many columns or rows away from a cell there may be pixels that the gradients in it hang on.
int reach_of_edges(const DetectOptions& options);

/// What detect_features() finds in some cells of a picture, bit for bit, by a window of it.
/// Chain::stepped is left open, nodes have any numbers: number_nodes(), sort_as_found() and mark_stepped()
/// make them those of detect_features().
/// @param part the pixels of the window: all of these cells, and around them, as far as the picture goes,
/// kEdgesApart cells and reach_of_edges() more.
/// @param wanted whole groups of cells with edges, and all around them: no cell with an edge that is not
/// wanted is less than kEdgesApart cells away. Chains are in the cell of their first point.
/// @param edges of these cells, those are marked that have an edge: a gradient above a threshold.
/// @throws Error{kInvalidArgument}, and threads, as detect_features().
FeatureChains detect_in_window(const image::Image& part, const PixelBox& window, const DetectOptions& options,
                               const CellMask& wanted, CellMask& edges);

/// Sets Chain::stepped by another picture than the one that the chains were detected in: the one that this
/// was enlarged from. detect_features() sets it by its own.
/// @param picture of the size of the chains, or half as wide and high.
/// @throws Error{kInvalidArgument} for other sizes.
void mark_stepped(const image::Image& picture, FeatureChains& chains);

}  // namespace knotreel::features
