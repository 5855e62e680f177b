#pragma once

#include <vector>

#include "knotreel/image/image.h"
#include "knotreel/spline/basis.h"

namespace knotreel::fit {

struct ColourFitOptions {
  /// Added to the diagonal of the normal equations, as a share of its largest entry: draws control points
  /// that few pixels decide towards the colour of the picture at their Greville sites. > 0.
  double ridge = 1e-5;
  /// Keeps the surface C1 (degree 2) or C2 (degree 3) at multiple knots too, see spline/smooth_corners.h.
  bool smooth_corners = true;
};

/// Colour control points of the least-squares fit to a picture whose pixels are parametrized by their own
/// centres (paper sec. 7.3, Eq. 13, with weight 1 for every pixel).
/// @param basis  over a domain of image.width x image.height pixels.
/// @return function by function, channels interleaved as in the image, scale 0..255, not clamped.
/// @throws Error{kInvalidArgument} if domain and picture differ in size.
/// Work is spread over all threads allowed; the result does not depend on their number. Memory: at most
/// about 300 MB for the basis functions of a band of rows, and the factor of the normal equations.
std::vector<double> fit_colours(const spline::Basis& basis, const image::Image& image,
                                const ColourFitOptions& options = {});

}  // namespace knotreel::fit
