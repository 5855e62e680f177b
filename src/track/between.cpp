// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/track/between.h"

#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/mesh/predicates.h"
#include "track/matching.h"

namespace knotreel::track {
namespace {

using mesh::Knot;
using mesh::KnotIndex;
using mesh::KnotKind;
using mesh::KnotMesh;

template <class Value>
Value on_the_way(Value from, Value to, double share) {
  return from + share * (to - from);
}

/// Border knots may have changed sides round a corner.
bool same_place(const KnotMesh& mesh, const Knot& a, const Knot& b) {
  if (a.kind != b.kind) return false;
  if (a.kind != KnotKind::kBorder) return true;
  const auto on_both = [](double x, double y, double side) { return x == side && y == side; };
  const Vec2 p = a.position;
  const Vec2 q = b.position;
  return on_both(p.x, q.x, 0) || on_both(p.x, q.x, mesh.width) || on_both(p.y, q.y, 0) ||
         on_both(p.y, q.y, mesh.height);
}

struct Moves {
  std::vector<Vec2> by_knot;
  std::vector<std::uint8_t> known;
};

/// Where knots of one mesh are in the other.
Moves moves_to(const KnotMesh& near, const KnotMesh& far) {
  std::unordered_map<std::uint32_t, const Knot*> by_id;
  for (const Knot& k : far.knots) by_id[static_cast<std::uint32_t>(k.id)] = &k;
  Moves moves{std::vector<Vec2>(near.knots.size()), std::vector<std::uint8_t>(near.knots.size(), 0)};
  for (std::size_t k = 0; k < near.knots.size(); ++k) {
    const auto found = by_id.find(static_cast<std::uint32_t>(near.knots[k].id));
    if (found == by_id.end() || !same_place(near, near.knots[k], *found->second)) continue;
    moves.by_knot[k] = found->second->position - near.knots[k].position;
    moves.known[k] = 1;
  }
  return moves;
}

/// Free knots whose way is not known take the mean of their neighbours'.
void go_along(const KnotMesh& mesh, Moves& moves) {
  std::vector<Vec2> sums(mesh.knots.size());
  std::vector<double> counts(mesh.knots.size(), 0);
  for (const mesh::Face& face : mesh.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (const KnotIndex other : {face[(i + 1) % 3], face[(i + 2) % 3]}) {
        if (!moves.known[other]) continue;
        sums[face[i]] = sums[face[i]] + moves.by_knot[other];
        counts[face[i]] += 1;
      }
    }
  }
  for (std::size_t k = 0; k < mesh.knots.size(); ++k) {
    const bool lost = !moves.known[k] && mesh.knots[k].kind == KnotKind::kFree && counts[k] > 0;
    if (lost) moves.by_knot[k] = (1 / counts[k]) * sums[k];
  }
}

/// Knots inside segments keep their place between the ends, which may have turned.
void straighten_segments(const KnotMesh& before, KnotMesh& mesh) {
  for (const mesh::FeatureSegment& s : mesh.segments) {
    const Vec2 from = before.knots[s.knots.front()].position;
    const Vec2 way = before.knots[s.knots.back()].position - from;
    const Vec2 new_from = mesh.knots[s.knots.front()].position;
    const Vec2 new_way = mesh.knots[s.knots.back()].position - new_from;
    for (std::size_t i = 1; i + 1 < s.knots.size(); ++i) {
      const double share = dot(before.knots[s.knots[i]].position - from, way) / dot(way, way);
      mesh.knots[s.knots[i]].position = new_from + share * new_way;
    }
  }
}

KnotMesh placed(const KnotMesh& near, const Moves& moves, double share) {
  KnotMesh mesh = near;
  for (std::size_t k = 0; k < mesh.knots.size(); ++k) {
    if (mesh.knots[k].kind == KnotKind::kSegment) continue;
    // What stays stays exactly: knots on a side are there to the last bit.
    mesh.knots[k].position = near.knots[k].position + share * moves.by_knot[k];
  }
  straighten_segments(near, mesh);
  return mesh;
}

/// Lets the free knots of a face go as its other knot goes, or all as they do in the mean: it cannot turn.
void stiffen(const KnotMesh& mesh, const mesh::Face& face, Moves& moves) {
  Vec2 way;
  for (const KnotIndex k : face) way = way + (1.0 / 3) * moves.by_knot[k];
  for (const KnotIndex k : face) {
    if (mesh.knots[k].kind != KnotKind::kFree) way = moves.by_knot[k];
  }
  for (const KnotIndex k : face) {
    if (mesh.knots[k].kind == KnotKind::kFree) moves.by_knot[k] = way;
  }
}

/// @return whether there were faces that are turned over.
bool stiffen_folded(const KnotMesh& mesh, Moves& moves) {
  bool any = false;
  for (const mesh::Face& f : mesh.faces) {
    const auto at = [&](std::size_t i) { return mesh.knots[f[i]].position; };
    if (mesh::orientation(at(0), at(1), at(2)) > 0) continue;
    any = true;
    stiffen(mesh, f, moves);
  }
  return any;
}

/// Faces may turn over where the frames are joined differently; they are made to move as a whole. None if
/// that does not help.
std::optional<KnotMesh> mesh_between(const KnotMesh& near, const KnotMesh& far, double share) {
  constexpr int kPasses = 20;
  Moves moves = moves_to(near, far);
  go_along(near, moves);
  for (int pass = 0; pass < kPasses; ++pass) {
    KnotMesh mesh = placed(near, moves, share);
    if (!stiffen_folded(mesh, moves)) return mesh;
  }
  return {};
}

/// The nearer frame, some of the way (at most a half) towards the other one.
document::FrameModel towards(const document::FrameModel& near, const document::FrameModel& far,
                             double share) {
  if (share == 0) return near;
  std::optional<KnotMesh> mesh = mesh_between(near.space->mesh(), far.space->mesh(), share);
  if (!mesh) return near;
  document::FrameModel model = near;
  model.space = std::make_shared<const spline::SplineSpace>(
      spline::SplineSpace::from_link_codes(std::move(*mesh), near.space->degree(), near.space->link_codes()));
  const std::vector<std::uint32_t> match = match_functions(*far.space, *near.space);
  const auto channels = static_cast<std::size_t>(near.channels);
  for (std::size_t f = 0; f < match.size(); ++f) {
    if (match[f] == kNoMatch) continue;
    const std::uint32_t group = near.space->geometry_of()[f];
    const std::uint32_t far_group = far.space->geometry_of()[match[f]];
    model.displacement[group] = on_the_way(near.displacement[group], far.displacement[far_group], share);
    for (std::size_t c = 0; c < channels; ++c) {
      model.colour[f * channels + c] =
          on_the_way(near.colour[f * channels + c], far.colour[match[f] * channels + c], share);
    }
  }
  return model;
}

/// Whether they may be frames of one document.
bool are_alike(const document::FrameModel& a, const document::FrameModel& b) {
  const KnotMesh& mesh = a.space->mesh();
  const KnotMesh& other = b.space->mesh();
  return mesh.width == other.width && mesh.height == other.height && a.space->degree() == b.space->degree() &&
         a.channels == b.channels;
}

}  // namespace

document::FrameModel between(const document::FrameModel& before, const document::FrameModel& after,
                             double share) {
  for (const document::FrameModel* model : {&before, &after}) {
    const std::optional<std::string> defect = document::find_defect(*model);
    if (defect) throw Error(ErrorKind::kInvalidArgument, "there is no frame beside one of which " + *defect);
  }
  if (!are_alike(before, after))
    throw Error(ErrorKind::kInvalidArgument, "frames of other size, degree or channels have none in between");
  if (!(share >= 0 && share <= 1))
    throw Error(ErrorKind::kInvalidArgument, "a frame between two is at a share from 0 to 1");
  return share < 0.5 ? towards(before, after, share) : towards(after, before, 1 - share);
}

}  // namespace knotreel::track
