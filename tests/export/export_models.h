// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <vector>

#include "support/models.h"

namespace knotreel::testing {

/// A model like a picture: colours that change slowly, and jump by about 120 levels across features.
inline document::FrameModel picture_like_model(const mesh::KnotMesh& mesh, int degree, int channels,
                                               double reach, std::uint64_t seed) {
  document::FrameModel model = blank_model(mesh, degree, channels);
  displace_randomly(model, reach, seed);
  const auto& space = *model.space;
  const auto& cut = space.cut();
  // +1 left of a feature and -1 right of it, by the direction in which it is stored; 0 for other corners.
  std::vector<double> side(cut.corners.size(), 0);
  for (mesh::CornerIndex c = 0; c < side.size(); ++c) {
    const mesh::Corner& corner = cut.corners[c];
    if (corner.closed || corner.first_line >= mesh.segments.size()) continue;
    const mesh::Line& line = cut.lines[corner.first_line];
    Vec2 centre;
    for (const auto n : cut.fan(c)) centre = centre + space.position(n) - space.position(c);
    side[c] = cross(line.to - line.from, centre) > 0 ? 1 : -1;
  }
  const auto count = static_cast<std::size_t>(channels);
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    const Vec2 g = space.greville(f);
    double jump = 0;
    int knots = 0;
    for (const auto c : space.functions()[f].knots) {
      if (c == spline::kNoCorner) continue;
      jump += side[c];
      ++knots;
    }
    for (std::size_t k = 0; k < count; ++k) {
      const auto phase = static_cast<double>(k);
      const double smooth = 127 + 40 * std::sin(0.05 * g.x + phase) + 25 * std::cos(0.07 * g.y - phase);
      model.colour[f * count + k] = smooth + 60 * jump / knots;
    }
  }
  return model;
}

/// Hand-made case of the corpus by name.
inline MeshCase corpus_case(const std::string& name) {
  for (MeshCase& c : corpus_cases()) {
    if (c.name == name) return c;
  }
  throw std::runtime_error("no case " + name);
}

}  // namespace knotreel::testing
