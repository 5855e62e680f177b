// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <functional>

#include "support/mesh_cases.h"

namespace knotreel::testing {

/// A feature of two segments that meet at an angle, in a domain of 64x48.
struct BentFeature {
  Vec2 left, middle, right;

  mesh::KnotMesh mesh() const {
    MeshBuilder b(64, 48);
    const mesh::KnotIndex knot = b.vertex(middle.x, middle.y);
    b.segment(b.vertex(left.x, left.y), knot, 1);
    b.segment(knot, b.vertex(right.x, right.y), 2);
    for (int i = 0; i < 6; ++i) {
      b.free(5.1 + 10.7 * i, 9.2 + 0.6 * (i % 2));
      b.free(4.7 + 10.9 * i, 38.4 + 0.7 * (i % 2));
    }
    return b.triangulated();
  }

  /// Angle between the two curves where they meet, radians. @param image where points of the domain are
  /// drawn.
  double bend(const std::function<Vec2(Vec2)>& image) const {
    constexpr double kStep = 1e-5;
    const Vec2 at = image(middle);
    const Vec2 before = at - image(middle + kStep * (left - middle));
    const Vec2 behind = image(middle + kStep * (right - middle)) - at;
    return std::abs(std::atan2(cross(before, behind), dot(before, behind)));
  }
};

}  // namespace knotreel::testing
