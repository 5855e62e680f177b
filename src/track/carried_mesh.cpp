// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/carried_mesh.h"

#include <algorithm>
#include <cstdint>

#include "knotreel/fit/geometry_fit.h"
#include "track/knot_motion.h"
#include "track/resting_knots.h"
#include "track/snap.h"

namespace knotreel::track {

namespace {

/// Adds the segments that could not follow their edges to the lost ones: in the wrong place they harm.
bool give_up_stuck(const CarryReport& report, std::vector<std::uint8_t>& lost) {
  bool any = false;
  for (const std::size_t i : report.stuck) {
    any = any || !lost[i];
    lost[i] = 1;
  }
  return any;
}

}  // namespace

std::vector<Vec2> image_positions(const FittedFrame& frame, const mesh::KnotMesh& mesh) {
  std::vector<Vec2> points;
  for (const mesh::Knot& k : mesh.knots) points.push_back(k.position);
  const std::vector<Vec2>& displacement = frame.displacement;
  if (std::all_of(displacement.begin(), displacement.end(), [](Vec2 d) { return d == Vec2{}; }))
    return points;
  return fit::image_points(*frame.basis, displacement, std::move(points));
}

mesh::KnotMesh carried_mesh(const FittedFrame& frame, const mesh::KnotMesh& mesh, const Motion& motion,
                            const motion::Rest& rest, const CarryOptions& options, CarryReport& report) {
  std::vector<Vec2> moves = knot_motion(mesh, image_positions(frame, mesh), motion);
  SnapResult snapped = snap_to_edges(*frame.basis, frame.displacement, mesh, moves, frame.seen.picture,
                                     *motion.before, *motion.now);
  const std::vector<std::uint8_t> rests = resting_knots(mesh, rest);
  for (std::size_t k = 0; k < moves.size(); ++k) moves[k] = rests[k] ? Vec2{} : moves[k] + snapped.moves[k];
  const std::vector<Vec2> targets = knot_targets(mesh, moves);
  mesh::KnotMesh carried = carry_mesh(mesh, targets, snapped.lost, options, &report);
  if (!give_up_stuck(report, snapped.lost)) return carried;
  return carry_mesh(mesh, targets, snapped.lost, options, &report);
}

}  // namespace knotreel::track
