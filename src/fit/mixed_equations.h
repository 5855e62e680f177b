// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "fit/normal_equations.h"
#include "knotreel/fit/mixed_pixels.h"
#include "knotreel/spline/basis.h"

namespace knotreel::fit {

/// Those of mixed pixels alone, to be added to those of others with the same functions sought.
NormalEquations mixed_equations(const spline::Basis& basis, const MixedPixels& mixed, const Sought& sought,
                                int channels);

}  // namespace knotreel::fit
