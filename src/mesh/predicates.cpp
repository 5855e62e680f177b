// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/mesh/predicates.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace knotreel::mesh {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

Kernel::Point_2 point(Vec2 p) {
  return {p.x, p.y};
}

}  // namespace

int orientation(Vec2 a, Vec2 b, Vec2 c) {
  return static_cast<int>(CGAL::orientation(point(a), point(b), point(c)));
}

bool in_circle(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  return CGAL::side_of_oriented_circle(point(a), point(b), point(c), point(d)) == CGAL::ON_POSITIVE_SIDE;
}

}  // namespace knotreel::mesh
