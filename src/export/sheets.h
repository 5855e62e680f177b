// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/export/tessellate.h"
#include "knotreel/spline/basis.h"
#include "mesh/half_edges.h"

namespace knotreel::exporting {

using mesh::CornerIndex;
using mesh::kNoHalfEdge;

/// A cubic Bezier curve in the image.
using Curve = std::array<Vec2, 4>;

/// A closed path: every curve goes on where the one before ends.
using Loop = std::vector<Curve>;

/// The surface of a model with the topology of its cut mesh: which half edges are walls, and points seen from
/// a given side. Half edge 3*f + i runs from corner i of face f to the next. Immutable, thread safe.
class Sheets {
 public:
  explicit Sheets(const document::FrameModel& model);

  const document::FrameModel& model() const { return model_; }
  std::span<const std::array<CornerIndex, 3>> faces() const { return cut().faces; }
  std::size_t half_edge_count() const { return half_edges_.opposite.size(); }

  /// The same edge seen from the face on its other side; kNoHalfEdge on the border of the picture.
  std::uint32_t opposite(std::uint32_t h) const { return half_edges_.opposite[h]; }
  bool is_feature(std::uint32_t h) const { return feature_[h]; }
  CornerIndex origin(std::uint32_t h) const { return cut().faces[h / 3][h % 3]; }
  CornerIndex target(std::uint32_t h) const { return origin(mesh::HalfEdges::next(h)); }

  /// Half edges that begin in a corner, ascending: one per face of its fan.
  std::span<const std::uint32_t> around(CornerIndex c) const {
    return std::span(around_).subspan(around_begin_[c], around_begin_[c + 1] - around_begin_[c]);
  }

  Vec2 parameter(CornerIndex c) const { return model_.space->position(c); }
  const SurfacePoint& at_corner(CornerIndex c) const { return corner_points_[c]; }

  /// The surface at u, as the limit from the side of `direction`.
  SurfacePoint at(Vec2 u, Vec2 direction) const;
  /// The same for a point that is on no feature.
  SurfacePoint at(Vec2 u) const;
  /// The same for a point on half edge h but at none of its ends, seen from the face of h.
  SurfacePoint beside(std::uint32_t h, Vec2 u) const;
  /// The point at t in [0,1] along half edge h, seen from its face.
  SurfacePoint on_edge(std::uint32_t h, double t) const;

  /// Image of a half edge that is a feature: between two neighbouring knots the geometry is one polynomial
  /// curve of the degree of the surface, so this is exact.
  Curve curve(std::uint32_t h) const;

 private:
  const mesh::CutMesh& cut() const { return model_.space->cut(); }

  const document::FrameModel& model_;
  spline::Basis basis_;
  mesh::HalfEdges half_edges_;
  std::vector<bool> feature_;
  std::vector<std::uint32_t> around_;
  std::vector<std::size_t> around_begin_;
  std::vector<SurfacePoint> corner_points_;
};

}  // namespace knotreel::exporting
