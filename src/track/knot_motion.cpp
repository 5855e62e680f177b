// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/knot_motion.h"

#include <cstddef>
#include <cstdint>

#include "knotreel/motion/refine_motion.h"
#include "knotreel/motion/still.h"

namespace knotreel::track {

namespace {

using motion::Stillness;

constexpr double kLong = 1;  // pixels; with less, a knot that stays is in nobody's way for a while

/// By knot, how many of the other corners of its faces count.
template <typename Counts>
std::vector<std::uint32_t> corners_around(const mesh::KnotMesh& mesh, const Counts& counts) {
  std::vector<std::uint32_t> result(mesh.knots.size(), 0);
  for (const mesh::Face& face : mesh.faces) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 1; j < 3; ++j) {
        if (counts(face[(i + j) % 3])) ++result[face[i]];
      }
    }
  }
  return result;
}

/// Which knots stay. From those that surely go on, what may do either goes along, ring by ring.
std::vector<bool> resting(const mesh::KnotMesh& mesh, std::span<const Vec2> moves,
                          std::span<const Stillness> stillness) {
  std::vector<bool> rests(moves.size());
  for (std::size_t k = 0; k < rests.size(); ++k) rests[k] = stillness[k] != Stillness::kMoves;
  const std::vector<std::uint32_t> all = corners_around(mesh, [](mesh::KnotIndex) { return true; });
  for (bool any = true; any;) {
    any = false;
    const std::vector<std::uint32_t> going =
        corners_around(mesh, [&](mesh::KnotIndex k) { return !rests[k]; });
    for (std::size_t k = 0; k < rests.size(); ++k) {
      const bool goes_along =
          rests[k] && stillness[k] == Stillness::kEither && norm(moves[k]) > kLong && 2 * going[k] >= all[k];
      if (!goes_along) continue;
      rests[k] = false;
      any = true;
    }
  }
  return rests;
}

}  // namespace

std::vector<Vec2> knot_motion(const mesh::KnotMesh& mesh, std::span<const Vec2> points,
                              const Motion& motion) {
  std::vector<Vec2> moves = motion::point_motion(points, motion.flow.forward, motion.flow.consistent);
  const std::vector<bool> rests =
      resting(mesh, moves, motion::still_points(points, moves, *motion.before, *motion.now, *motion.moved));
  for (std::size_t k = 0; k < moves.size(); ++k) {
    if (rests[k]) moves[k] = {};
  }
  motion::refine_motion(points, moves, *motion.before, *motion.now);
  return moves;
}

}  // namespace knotreel::track
