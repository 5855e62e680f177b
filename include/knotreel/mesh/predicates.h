// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/vec2.h"

/// Exact geometric predicates on doubles (CGAL, filtered).
namespace knotreel::mesh {

/// Sign of signed_area(a, b, c): 1, 0 or -1.
int orientation(Vec2 a, Vec2 b, Vec2 c);

/// Whether d lies strictly inside the circle through a, b, c, which are in positive order.
bool in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d);

}  // namespace knotreel::mesh
