// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "knotreel/document/frame_model.h"
#include "knotreel/fit/colour_fit.h"
#include "knotreel/spline/basis.h"
#include "knotreel/spline/pixel_surface.h"
#include "track/placed_pixels.h"

namespace knotreel::track {

/// What features of a drawn frame may cost, and which of them were left out for that.
struct FeatureLimits {
  double share = 0;  ///< as vectorize::Report
  bool weak_dropped = false;
  bool strong_dropped = false;
  bool fine_grid = false;  ///< they were found there
};

/// A frame and the surface that was fitted to it.
struct FittedFrame {
  std::shared_ptr<const spline::SplineSpace> space;
  std::vector<Vec2> displacement;
  double edge_softness = 0;                             ///< as document::FrameModel
  double colour_step = 0;                               ///< of the colours, levels
  std::shared_ptr<const spline::Basis> basis;           ///< of the space
  PlacedPixels seen;                                    ///< what was fitted
  fit::ColourFit colours;                               ///< the residual is that of what was seen
  std::shared_ptr<const spline::PixelSurface> surface;  ///< at what was seen
  /// Of one that is drawn: the features of the next one are found in its picture.
  std::optional<FeatureLimits> drawn;
  bool dense = false;    ///< by TrackOptions::dense, dense_film or cramped
  bool cramped = false;  ///< by that

  // Of warm frames, while parts of the picture rest (docs/decisions/0027); else empty.
  std::vector<std::uint64_t> prints;  ///< spline::function_fingerprints()
  std::vector<std::uint8_t> ages;     ///< of the functions, as Kept::ages()
  std::vector<std::uint8_t> same;     ///< tiles, as Kept::surface()

  /// Of the basis, at the places of what is seen.
  const spline::PixelValues& values() const { return seen.placed->values(); }
};

/// As a delta frame has it.
document::FrameModel model_of(const FittedFrame& frame, int channels);

/// Of the residual, summed over the channels; per pixel, 0 where features cross.
std::vector<float> squared_errors(const FittedFrame& frame);

}  // namespace knotreel::track
