// SPDX-License-Identifier: GPL-3.0-or-later
#include "document/frame_state.h"

#include <algorithm>
#include <cmath>

namespace knotreel::document {

FrameModel to_model(const FrameState& state, const Format& format) {
  FrameModel model;
  model.space = state.space;
  model.channels = format.info.channels;
  model.frame = state.frame;
  model.pts = state.pts;
  model.keyframe = state.keyframe;
  if (!state.keyframe) model.colour_step = static_cast<double>(state.colour_unit) * format.colour_scale();
  model.edge_softness = state.edge_softness * kEdgeSoftnessStep;
  model.function_ids = state.function_ids;
  // The steps have few bits, so these products are exact.
  model.displacement.reserve(state.displacement.size() / 2);
  for (std::size_t i = 0; i + 1 < state.displacement.size(); i += 2) {
    model.displacement.push_back(
        {static_cast<double>(state.displacement[i]) * format.displacement_scale(),
         static_cast<double>(state.displacement[i + 1]) * format.displacement_scale()});
  }
  model.colour.reserve(state.colour.size());
  for (const std::int64_t c : state.colour)
    model.colour.push_back(static_cast<double>(c) * format.colour_scale());
  return model;
}

GridPoint in_sixteenths(GridPoint p, int bits) {
  constexpr int kBits = 4;
  if (bits >= kBits) return {p.x >> (bits - kBits), p.y >> (bits - kBits)};
  const std::int64_t scale = std::int64_t{1} << (kBits - bits);
  return {p.x * scale, p.y * scale};
}

std::vector<std::int64_t> polygon_areas(const spline::SplineSpace& space, const KnotGrid& grid) {
  std::vector<GridPoint> points;
  points.reserve(space.cut().corners.size());
  for (const mesh::Corner& c : space.cut().corners) {
    points.push_back(in_sixteenths(grid.points[c.knot], grid.bits));
  }
  // A hostile link can go to and fro so often that sums wrap.
  std::vector<std::uint64_t> sums(space.function_count());
  for (const spline::Config& c : space.configs()) {
    for (std::size_t v = 0; v < 3; ++v) {
      const spline::FunctionIndex f = c.functions[v];
      if (f == spline::kNoFunction) continue;
      const GridPoint o = points[space.functions()[f].knots[0]];
      const GridPoint a = points[c.triangle[(v + 1) % 3]];
      const GridPoint b = points[c.triangle[(v + 2) % 3]];
      sums[f] += static_cast<std::uint64_t>((a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x));
    }
  }
  constexpr std::int64_t kMost = std::int64_t{1} << 50;  // more than the largest domain has
  std::vector<std::int64_t> areas;
  areas.reserve(sums.size());
  for (const std::uint64_t s : sums) {
    areas.push_back(std::clamp(static_cast<std::int64_t>(s), -kMost, kMost));
  }
  return areas;
}

void set_kinds(mesh::KnotMesh& mesh, KnotIndex border_count, const std::array<KnotIndex, 4>& domain_corners) {
  for (KnotIndex k = 0; k < mesh.knots.size(); ++k) {
    mesh.knots[k].kind = k < border_count ? KnotKind::kBorder : KnotKind::kFree;
  }
  for (const mesh::FeatureSegment& s : mesh.segments) {
    for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) mesh.knots[s.knots[i]].kind = KnotKind::kSegment;
  }
  for (const mesh::FeatureSegment& s : mesh.segments) {
    mesh.knots[s.knots.front()].kind = KnotKind::kVertex;
    mesh.knots[s.knots.back()].kind = KnotKind::kVertex;
  }
  for (const KnotIndex k : domain_corners) mesh.knots[k].kind = KnotKind::kVertex;
}

void set_positions(mesh::KnotMesh& mesh, const KnotGrid& grid) {
  const double unit = std::ldexp(1.0, -grid.bits);
  for (KnotIndex k = 0; k < mesh.knots.size(); ++k) {
    mesh.knots[k].position = {static_cast<double>(grid.points[k].x) * unit,
                              static_cast<double>(grid.points[k].y) * unit};
  }
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 a = mesh.knots[s.knots.front()].position;
    const Vec2 b = mesh.knots[s.knots.back()].position;
    for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
      const double t = static_cast<double>(grid.parameters[s.knots[i]]) / static_cast<double>(kSegmentUnit);
      mesh.knots[s.knots[i]].position = {a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)};
    }
  }
}

}  // namespace knotreel::document
