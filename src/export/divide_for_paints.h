#pragma once

#include "export/triangulation.h"

namespace knotreel::exporting {

/// Halves triangles whose channels change in so different directions that no paint fits: at their longest
/// edges, together with what lies beyond those. Triangles of less than a pixel stay whole.
/// @param channels  the first so many count. @param tolerance  in levels.
void divide_for_paints(Triangulation& triangles, std::size_t channels, double tolerance);

}  // namespace knotreel::exporting
