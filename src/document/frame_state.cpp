#include "document/frame_state.h"

#include <cmath>

namespace knotreel::document {

FrameModel to_model(const FrameState& state, const Format& format) {
  FrameModel model;
  model.space = state.space;
  model.channels = format.info.channels;
  model.frame = state.frame;
  model.pts = state.pts;
  model.keyframe = state.keyframe;
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
