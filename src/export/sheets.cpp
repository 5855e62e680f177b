// SPDX-License-Identifier: GPL-3.0-or-later
#include "export/sheets.h"

#include <algorithm>

#include "knotreel/base/error.h"

namespace knotreel::exporting {

namespace {

mesh::HalfEdges connected(const document::FrameModel& model) {
  auto half_edges = mesh::connect_half_edges(model.space->mesh().faces);
  if (!half_edges) throw Error(ErrorKind::kInvalidArgument, "cannot export the mesh: its faces do not join");
  return std::move(*half_edges);
}

}  // namespace

Sheets::Sheets(const document::FrameModel& model)
    : model_(model), basis_(model.space), half_edges_(connected(model)) {
  // The two sides of a feature have different corners, at least at one end of every edge.
  feature_.resize(half_edge_count());
  for (std::uint32_t h = 0; h < half_edge_count(); ++h) {
    const std::uint32_t o = opposite(h);
    feature_[h] = o != kNoHalfEdge && (origin(h) != target(o) || target(h) != origin(o));
  }

  const std::size_t corners = cut().corners.size();
  around_begin_.assign(corners + 1, 0);
  for (std::uint32_t h = 0; h < half_edge_count(); ++h) ++around_begin_[origin(h) + 1];
  for (std::size_t c = 0; c < corners; ++c) around_begin_[c + 1] += around_begin_[c];
  around_.resize(half_edge_count());
  std::vector<std::size_t> cursor(around_begin_.begin(), around_begin_.end() - 1);
  for (std::uint32_t h = 0; h < half_edge_count(); ++h) around_[cursor[origin(h)]++] = h;

  corner_points_.resize(corners);
  for (CornerIndex c = 0; c < corners; ++c) {
    // All faces of a sector see the same limit; the first stands for all, so that they get equal bits.
    const auto& face = faces()[around(c)[0] / 3];
    const Vec2 centre = (1.0 / 3) * (parameter(face[0]) + parameter(face[1]) + parameter(face[2]));
    corner_points_[c] = at(parameter(c), centre - parameter(c));
  }
}

SurfacePoint Sheets::at(Vec2 u, Vec2 direction) const {
  std::vector<spline::BasisValue> values;
  basis_.evaluate(u, direction, values);
  const auto geometry_of = model_.space->geometry_of();
  const auto channels = static_cast<std::size_t>(model_.channels);
  SurfacePoint point{u, u, {}};
  for (const spline::BasisValue& b : values) {
    point.x = point.x + b.value * model_.displacement[geometry_of[b.function]];
    for (std::size_t c = 0; c < channels; ++c) {
      point.colour[c] += b.value * model_.colour[b.function * channels + c];
    }
  }
  for (double& c : point.colour) c = std::clamp(c, 0.0, 255.0);
  return point;
}

SurfacePoint Sheets::at(Vec2 u) const {
  const auto& mesh = model_.space->mesh();
  return at(u, spline::inward_direction(u, mesh.width, mesh.height));
}

SurfacePoint Sheets::beside(std::uint32_t h, Vec2 u) const {
  if (!is_feature(h)) return at(u);
  const Vec2 along = parameter(target(h)) - parameter(origin(h));
  return at(u, {-along.y, along.x});  // faces are in positive order
}

SurfacePoint Sheets::on_edge(std::uint32_t h, double t) const {
  if (t == 0) return at_corner(origin(h));
  if (t == 1) return at_corner(target(h));
  const Vec2 a = parameter(origin(h));
  return beside(h, a + t * (parameter(target(h)) - a));
}

Curve Sheets::curve(std::uint32_t h) const {
  const Vec2 p0 = on_edge(h, 0).x;
  const Vec2 q0 = on_edge(h, 1.0 / 3).x;
  const Vec2 q1 = on_edge(h, 2.0 / 3).x;
  const Vec2 p1 = on_edge(h, 1).x;
  // The cubic through four points; polynomials of lower degree come out as such.
  return {p0, (1.0 / 6) * (-5 * p0 + 18 * q0 - 9 * q1 + 2 * p1),
          (1.0 / 6) * (2 * p0 - 9 * q0 + 18 * q1 - 5 * p1), p1};
}

}  // namespace knotreel::exporting
