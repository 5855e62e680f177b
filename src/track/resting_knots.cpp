// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/resting_knots.h"

#include "base/box.h"

namespace knotreel::track {

namespace {

constexpr Vec2 kAround{4, 4};  // pixels

}  // namespace

std::vector<std::uint8_t> resting_knots(const mesh::KnotMesh& mesh, const motion::Rest& rest) {
  if (rest.share() == 0) return std::vector<std::uint8_t>(mesh.knots.size(), 0);
  std::vector<Box> stars(mesh.knots.size());
  for (const mesh::Face& face : mesh.faces) {
    for (const mesh::KnotIndex at : face) {
      for (const mesh::KnotIndex corner : face) stars[at].add(mesh.knots[corner].position);
    }
  }
  std::vector<std::uint8_t> result(stars.size());
  for (std::size_t k = 0; k < stars.size(); ++k)
    result[k] = rest.holds(stars[k].low - kAround, stars[k].high + kAround) ? 1 : 0;
  return result;
}

std::vector<std::uint8_t> resting_geometry(const spline::SplineSpace& space,
                                           const std::vector<std::uint8_t>& resting) {
  std::vector<std::uint8_t> result(space.geometry_count(), 1);
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    for (const mesh::CornerIndex c : space.functions()[f].knots) {
      if (c != spline::kNoCorner && !resting[space.cut().corners[c].knot]) result[space.geometry_of()[f]] = 0;
    }
  }
  return result;
}

}  // namespace knotreel::track
