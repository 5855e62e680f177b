// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "export/triangulation.h"

namespace knotreel::exporting {

/// Halves triangles whose channels change in so different directions that no paint fits: at their longest
/// edges, together with what lies beyond those. Triangles of less than a pixel stay whole.
/// @param channels  the first so many count. @param tolerance  in levels.
/// @param max_triangles, checkpoint  as ExportOptions.
/// @throws Error{kInvalidArgument} for more triangles than that: a displaced face may be of any size.
void divide_for_paints(Triangulation& triangles, std::size_t channels, double tolerance,
                       std::uint64_t max_triangles, const std::function<void()>& checkpoint);

}  // namespace knotreel::exporting
