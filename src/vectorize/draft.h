// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "knotreel/document/frame_model.h"
#include "knotreel/fit/descend.h"
#include "knotreel/spline/pixel_values.h"
#include "vectorize/samples.h"

namespace knotreel::vectorize {

/// The model as far as it is made.
struct Draft {
  fit::ColourSurface surface;
  std::unique_ptr<const fit::SpaceAtPixels> steering;  ///< the surface's space there; null behind the rounds
  bool fits_all_pixels = false;  ///< whether the residual is of all pixels rather than the steering ones
  std::vector<Vec2> displacement;
  std::vector<double> curve_errors;  ///< pixels, parallel to Samples::curves(); empty: not measured
  double meg = 0;                    ///< mean of the last ones that were measured
  double edge_softness = 0;

  document::FrameModel model(int channels) const;
};

/// Fits the colours to all pixels, from the ones that the draft has. @param basis of its space.
/// @param mixed the pixels that features cross, as mixtures; or null.
void fit_all_pixels(const spline::Basis& basis, const Samples& samples, const fit::ColourFitOptions& options,
                    Draft& draft, const fit::MixedPixels* mixed = nullptr);
/// Fits the geometry, if there are features. @param values of the draft's functions at the places of the
/// samples.
void fit_geometry(const spline::PixelValues& values, const Samples& samples,
                  const fit::GeometryFitOptions& options, Draft& draft);
void measure_curves(const spline::Basis& basis, const Samples& samples, Draft& draft);

/// Writes MEC and PSNR of the residual, over the pixels that count.
void measure_colours(const Samples& samples, const Draft& draft, RoundReport& report);
/// Of the residual, for all pixels.
std::vector<float> squared_errors(const Samples& samples, const Draft& draft);

}  // namespace knotreel::vectorize
