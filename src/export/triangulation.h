// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "export/paint.h"
#include "knotreel/export/tessellate.h"

namespace knotreel::exporting {

inline constexpr std::uint32_t kNoIndex = 0xffffffffu;

/// Where an edge of a triangle lies on a feature: from t0 to t1 along a half edge of the cut mesh.
struct FeaturePiece {
  std::uint32_t half_edge = 0;
  double t0 = 0;
  double t1 = 1;
};

/// The whole surface as triangles with linear colours that share their vertices. Half edge 3*t + i runs from
/// corner i of triangle t to the next.
struct Triangulation {
  std::vector<Vec2> x;  ///< positions in the image, by vertex
  std::vector<std::array<std::uint32_t, 3>> triangles;
  /// By corner 3*t + i: triangles on the two sides of a feature have different colours at one vertex.
  std::vector<std::array<float, 4>> colour;
  std::vector<std::uint32_t> opposite;  ///< by half edge; kNoIndex at the border
  std::vector<std::uint32_t> piece;     ///< by half edge: index in `pieces`, kNoIndex off the features
  std::vector<FeaturePiece> pieces;

  Vec2 origin(std::uint32_t h) const { return x[vertex(h)]; }
  std::uint32_t vertex(std::uint32_t h) const { return triangles[h / 3][h % 3]; }
  std::uint32_t target(std::uint32_t h) const { return triangles[h / 3][(h + 1) % 3]; }
};

struct Corners {
  std::array<Vec2, 3> x;
  std::array<Rgb, 3> colour{};
};

/// Of a triangle, with `count` channels from `first` on.
Corners corners_of(const Triangulation& triangles, std::uint32_t triangle, std::size_t first,
                   std::size_t count);

/// @param max_triangles, checkpoint  as ExportOptions.
/// @throws Error{kInvalidArgument} for more triangles than that.
Triangulation triangulate(const Tessellator& tessellator, std::uint64_t max_triangles,
                          const std::function<void()>& checkpoint);

}  // namespace knotreel::exporting
