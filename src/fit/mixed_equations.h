#pragma once

#include "fit/normal_equations.h"
#include "knotreel/fit/mixed_pixels.h"
#include "knotreel/spline/basis.h"

namespace knotreel::fit {

/// Adds the rows of mixed pixels to a least-squares problem. @param sought as it was assembled with.
void add_mixed_pixels(const spline::Basis& basis, const MixedPixels& mixed, const Sought& sought,
                      NormalEquations& normal);

}  // namespace knotreel::fit
