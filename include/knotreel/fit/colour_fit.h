// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/fit/pixels.h"
#include "knotreel/spline/basis.h"
#include "knotreel/spline/pixel_values.h"

namespace knotreel::fit {

/// What basis functions are evaluated in at pixels, and their products summed in over tiles of 8x8 pixels.
/// Their set-up, and the sums over tiles, are always double.
enum class Precision : std::uint8_t {
  kDouble,
  kSingle,  ///< quicker (docs/decisions/0022); functions are wrong by 2e-5, next to faces of 0.01 px by 1e-3
};

struct ColourFitOptions {
  /// Added to the diagonal of the normal equations, as a share of its largest entry: draws control points
  /// that few pixels decide towards the colour of the picture at their Greville sites. > 0.
  double ridge = 1e-5;
  /// Keeps the surface C1 (degree 2) or C2 (degree 3) at multiple knots too, but for functions that two of
  /// them share (spline/smooth_corners.h).
  bool smooth_corners = true;
  Precision precision = Precision::kDouble;
  bool find_residual = true;  ///< false: ColourFit has no residual and no squared error
  /// Control points near those of the fit, as in ColourFit::control: from there they are found quicker, to
  /// some hundredths of a level or a tenth of `step`. NaN: not known. Or none.
  std::span<const double> start = {};
  /// > 0: control points are multiples of this, levels, as documents store them; each is rounded with regard
  /// to what those around it were rounded to.
  double step = 0;
  /// With a step: how much each control point that has a start must gain to leave it; one per function, 0 or
  /// more, or none: 0. It stops short of where it would be best by half of this times the step, or by more
  /// where few pixels speak for it; so fewer of them move for noise.
  std::span<const double> reluctance = {};
  /// 1 for functions whose control points stay exactly at their start, which they have; 0 for those that are
  /// looked for. Or none: all are. Functions that corners are smoothed by together stay only if all of them
  /// may. Only tiles with others are looked at.
  std::span<const std::uint8_t> fixed = {};
};

struct ColourFit {
  /// Control points, function by function, channels interleaved as in the image, scale 0..255, not clamped.
  std::vector<double> control;
  /// Picture minus surface at the pixels, whatever their weights; row-major, channels interleaved.
  std::vector<float> residual;
  double squared_error = 0;  ///< sum of the weighted squares of the residual
};

/// Least-squares fit of the colours (paper sec. 7.3, Eq. 13).
/// @param basis  over a domain of image.width x image.height pixels.
/// @throws Error{kInvalidArgument} if sizes differ.
/// Work is spread over all threads allowed; the result does not depend on their number. Memory: for
/// each tile of 8x8 pixels the products of all pairs of the n functions that reach it, and four more numbers
/// for each of them, so n (n + 9) / 2 floats or doubles; and the factor of the normal equations.
ColourFit fit_colours(const spline::Basis& basis, const Pixels& pixels, const ColourFitOptions& options = {});

/// The same with the values of the basis functions at pixels.places, which may serve other fits too.
ColourFit fit_colours(const spline::PixelValues& values, const Pixels& pixels,
                      const ColourFitOptions& options = {});

}  // namespace knotreel::fit
