// SPDX-License-Identifier: GPL-3.0-or-later
#include "vectorize/initial_mesh.h"

#include <gtest/gtest.h>

namespace knotreel::vectorize {
namespace {

/// A polyline through these vertices.
param::Parametrization map_of(const std::vector<Vec2>& vertices, bool closed) {
  param::Parametrization map;
  map.width = map.height = 100;
  map.polylines.push_back({});
  map.polylines[0].closed = closed;
  for (const Vec2 p : vertices) {
    map.polylines[0].vertices.push_back(std::uint32_t(map.vertices.size()));
    map.vertices.push_back({p});
  }
  return map;
}

std::vector<std::size_t> knots_inside(const mesh::KnotMesh& mesh) {
  std::vector<std::size_t> counts;
  for (const mesh::FeatureSegment& s : mesh.segments) counts.push_back(s.knots.size() - 2);
  return counts;
}

TEST(InitialMesh, LongSegmentsHaveKnotsInside) {
  const mesh::KnotMesh mesh = initial_mesh(map_of({{10, 10}, {20, 12}, {70, 12}, {72, 60}}, false), 12, 3);
  EXPECT_EQ(knots_inside(mesh), (std::vector<std::size_t>{1, 3, 3}));
  EXPECT_FALSE(mesh::find_defect(mesh));
}

TEST(InitialMesh, ShortOnesHaveNoneBetweenOthers) {
  const std::vector<Vec2> box{{20, 22}, {22, 20}, {58, 20}, {60, 22}, {60, 58}, {58, 60}, {22, 60}, {20, 58}};
  const mesh::KnotMesh mesh = initial_mesh(map_of(box, true), 12, 3);
  EXPECT_EQ(knots_inside(mesh), (std::vector<std::size_t>{0, 2, 0, 2, 0, 2, 0, 2}));
  EXPECT_FALSE(mesh::find_defect(mesh));
  EXPECT_EQ(knots_inside(initial_mesh(map_of(box, true), 12, 0)),
            (std::vector<std::size_t>{1, 2, 1, 2, 1, 2, 1, 2}));
}

TEST(InitialMesh, AShortOneAloneHasOne) {
  const mesh::KnotMesh mesh = initial_mesh(map_of({{40, 40}, {41, 41.5}}, false), 12, 3);
  EXPECT_EQ(knots_inside(mesh), (std::vector<std::size_t>{1}));
  EXPECT_FALSE(mesh::find_defect(mesh));
}

}  // namespace
}  // namespace knotreel::vectorize
