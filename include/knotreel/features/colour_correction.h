// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/features/chains.h"
#include "knotreel/image/image.h"

namespace knotreel::features {

struct CorrectionOptions {
  double one_ring = 0.4;  ///< weight of the mean of the one-ring neighbours, >= 0
  double two_ring = 0.6;  ///< weight of the mean of the two-ring neighbours, >= 0; both sum to 1
  /// Means over pixels that do not lie beside features themselves. On edges that are blurred the colours come
  /// 2 to 10 times nearer to those of the sides; on noisy hard ones fewer pixels average the noise (decision
  /// 8).
  bool clean_only = false;
  /// How far pixels go from their own colours to those of their side, 0 to 1 (the paper's). A sharp edge has
  /// a colour of its side there already; a lens leaves a mixture, of which the rest stays in the picture.
  double strength = 1;
};

/// The picture with the mixed colours beside features replaced (paper Eq. 6): each pixel in the one-ring of a
/// feature takes a weighted mean of its one-ring and two-ring neighbours that are no feature pixels and lie
/// on its own side, that is, can be reached over edges of the image mesh. Feature pixels keep their colours,
/// and so do pixels whose two-ring holds none that is away from features (thin strips): there is nothing
/// clean to take colours from.
/// @param image of the size of `chains`; all channels alike
/// @throws Error{kInvalidArgument} for options out of range or sizes that differ.
/// Safe to call from several threads; equal input gives equal bits for any thread count.
image::Image correct_colours(const image::Image& image, const FeatureChains& chains,
                             const CorrectionOptions& options = {});

}  // namespace knotreel::features
