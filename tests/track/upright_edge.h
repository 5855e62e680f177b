// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "knotreel/image/image.h"
#include "knotreel/mesh/triangulate.h"
#include "knotreel/spline/basis.h"

namespace knotreel::track {

/// Dark at the left of x and so much brighter at the right, about as soft as cameras and antialiasing make
/// it.
inline image::Image upright_edge(double x, double contrast = 150) {
  constexpr double kSoftness = 1.2;  // pixels
  image::Image picture = image::make_image(64, 64, 1);
  for (int row = 0; row < picture.height; ++row) {
    for (int column = 0; column < picture.width; ++column) {
      const double share = 0.5 + 0.5 * std::erf((column + 0.5 - x) / kSoftness);
      picture.at(column, row, 0) = static_cast<float>(40 + contrast * share);
    }
  }
  return picture;
}

/// A surface at rest with one segment, which goes down from (32, 8).
struct UprightSegment {
  explicit UprightSegment(double length) {
    mesh::KnotMesh mesh = mesh::make_domain(64, 64);
    const auto add = [&](double y, mesh::KnotKind kind) {
      const auto index = static_cast<mesh::KnotIndex>(mesh.knots.size());
      mesh.knots.push_back({{32, y}, kind, mesh::KnotId{index}});
      return index;
    };
    from = add(8, mesh::KnotKind::kVertex);
    const mesh::KnotIndex inside = add(8 + length / 2, mesh::KnotKind::kSegment);
    to = add(8 + length, mesh::KnotKind::kVertex);
    mesh.segments.push_back({{from, inside, to}});
    mesh::triangulate(mesh);
    basis = std::make_unique<spline::Basis>(std::make_shared<const spline::SplineSpace>(mesh, 2));
    displacement.resize(basis->space().geometry_count());
    still.resize(mesh.knots.size());
  }

  const mesh::KnotMesh& mesh() const { return basis->space().mesh(); }

  mesh::KnotIndex from = 0;
  mesh::KnotIndex to = 0;
  std::unique_ptr<spline::Basis> basis;
  std::vector<Vec2> displacement;  ///< none
  std::vector<Vec2> still;         ///< motion of knots that do not move
};

}  // namespace knotreel::track
