// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/carry_mesh.h"

namespace knotreel::track {

using mesh::KnotIndex;
using mesh::KnotKind;
using mesh::KnotMesh;

namespace {

bool on_vertical_side(const KnotMesh& mesh, Vec2 p) {
  return p.x == 0 || p.x == mesh.width;
}

bool on_horizontal_side(const KnotMesh& mesh, Vec2 p) {
  return p.y == 0 || p.y == mesh.height;
}

/// Along the side that the point is on.
Vec2 slide(const KnotMesh& mesh, Vec2 p, Vec2 motion) {
  if (on_vertical_side(mesh, p)) motion.x = 0;
  if (on_horizontal_side(mesh, p)) motion.y = 0;
  return p + motion;
}

}  // namespace

std::vector<Vec2> knot_targets(const KnotMesh& mesh, std::span<const Vec2> motion) {
  std::vector<Vec2> targets(mesh.knots.size());
  for (KnotIndex k = 0; k < targets.size(); ++k) {
    const Vec2 p = mesh.knots[k].position;
    switch (mesh.knots[k].kind) {
      case KnotKind::kFree:
        targets[k] = p + motion[k];
        break;
      case KnotKind::kVertex:
        targets[k] = slide(mesh, p, motion[k]);
        break;
      default:
        targets[k] = p;
    }
  }
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const KnotIndex a = s.knots.front();
    const KnotIndex b = s.knots.back();
    const Vec2 from = mesh.knots[a].position;
    const Vec2 along = mesh.knots[b].position - from;
    if (targets[a] == from && targets[b] == mesh.knots[b].position) continue;
    for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
      const double t = dot(mesh.knots[s.knots[i]].position - from, along) / dot(along, along);
      targets[s.knots[i]] = targets[a] + t * (targets[b] - targets[a]);
    }
  }
  return targets;
}

}  // namespace knotreel::track
