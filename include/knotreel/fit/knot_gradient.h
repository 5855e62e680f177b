// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/fit/colour_fit.h"

namespace knotreel::fit {

/// Gradient of the squared error of the best colour fit by the positions of the knots, in squared levels per
/// pixel: by variable projection it is -2 r^T (dA/dt) c, with the control points c held (docs/algorithm.md,
/// "descent on the true residual"). dA/dt is taken for each config of
/// Gamma_{k-1} on its own: there the functions are piecewise products of linear ones, and one pass over the
/// pixels sums up what their coefficients bring, for all knots; how these follow the knots is known of affine
/// maps, and differenced for knots beyond the first three. Zero for knots of kind kVertex; for border and
/// segment knots the component along their line.
/// @param values of the basis functions at pixels.places, all functions wanted.
/// @param fit    of the same basis and pixels.
/// @param wanted one per knot: 0 leaves its gradient zero, and configs without a wanted knot cost nothing; or
///               none: all knots. The others get the same bits either way.
/// @throws Error{kInvalidArgument} if `wanted` has another size.
/// Parallel; same bits for any number of threads.
std::vector<Vec2> knot_gradient(const spline::PixelValues& values, const Pixels& pixels, const ColourFit& fit,
                                std::span<const std::uint8_t> wanted = {});

}  // namespace knotreel::fit
