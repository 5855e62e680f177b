// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "knotreel/base/error.h"
#include "knotreel/features/chains.h"
#include "knotreel/features/known_corners.h"
#include "knotreel/image/image.h"

namespace knotreel::features {

struct CornerOptions {
  double least_turn = 25;  ///< degrees, 0..180: what turns less is a bend
  /// Root mean square error that one colour for each side of the corner may leave in the pixels around it,
  /// as a share of their difference, > 0.
  double most_error = 0.05;

  bool operator==(const CornerOptions&) const = default;
};

/// Sharp corners (docs/decisions/0039). The detector smooths the picture: its curves go round corners at up
/// to two pixels, and cut off the tips of acute ones. Where a curve is straight on both sides of a turn, the
/// corner is about where these lines meet, and exactly where two colours explain the pixels around it best,
/// if they do. Points near by go to the lines, one of them to the corner, which is marked
/// (ChainPoint::corner). Pixels stay. Nodes where three or more curves meet are found in the same way, one
/// colour for each area between them.
///
/// Of stepped chains only sides along rows and columns count: others say too little about where they lead.
/// @param image   as it was drawn: of the size of the chains, or half as wide and high, if they were detected
/// in it enlarged. Two colours explain only pixels that nothing was done to.
/// @param chains  detected in that picture, and faired. Their positions may be moved by up to three of its
/// pixels, what is then too far from the pixel goes to ChainPoint::beyond.
/// @param known   of other pictures, or of this one with other chains; may be null. What is new goes in.
/// @return how many corners and nodes there are.
/// @throws Error{kInvalidArgument} if picture and chains are of different sizes, or options are out of range.
/// Linear time. The same bits for any number of threads. Safe to call from several threads on different
/// chains.
std::size_t sharpen_corners(const image::Image& image, FeatureChains& chains,
                            const CornerOptions& options = {}, KnownCorners* known = nullptr);

}  // namespace knotreel::features
