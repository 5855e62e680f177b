#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/image/image.h"
#include "knotreel/motion/flow.h"
#include "knotreel/motion/luma.h"

namespace knotreel::motion {

/// How much a picture differs from the one before it.
struct CutMeasure {
  /// Distance of the histograms, 0 (equal) to 1 (nothing in common): the mean of that of luma and that of
  /// chroma; luma alone if one of the pictures is grey.
  double histogram = 0;
  /// Mean absolute difference of luma along the flow, in levels.
  double residual = 0;
  /// Share of pixels whose flow is not consistent.
  double unmatched = 0;
  /// How little texture is kept along the flow, 0 (all of it, or there is none) to 1 (nothing): one minus the
  /// correlation, within blocks, of luma averaged over a few pixels. Light hardly shows, nor does noise.
  double unlike = 0;
};

struct CutOptions {
  double threshold = 0.4;  ///< least CutMeasure::unlike of a cut
};

/// @param before, now pictures of one size; their channels may differ.
/// @param forward flow from `before` to `now`.
/// @param consistent as from consistent(), for the pixels of `before`.
/// @throws Error{kInvalidArgument} if sizes differ or a picture is empty.
/// All threads are used; the result does not depend on their number.
CutMeasure measure_change(const image::Image& before, const image::Image& now, const Flow& forward,
                          const std::vector<std::uint8_t>& consistent);

/// The same for callers who have the luma of both pictures.
CutMeasure measure_change(const image::Image& before, const image::Image& now, const Luma& luma_before,
                          const Luma& luma_now, const Flow& forward,
                          const std::vector<std::uint8_t>& consistent);

/// Whether a new scene begins with the second picture. Meant for hard cuts: fades, moving cameras and light
/// that changes are one scene. Pictures without texture are all alike; whoever has such looks at the
/// histogram.
bool is_cut(const CutMeasure& measure, const CutOptions& options = {});

}  // namespace knotreel::motion
