#include "track/knot_motion.h"

#include <cstddef>
#include <cstdint>

#include "knotreel/motion/refine_motion.h"
#include "knotreel/motion/still.h"

namespace knotreel::track {

namespace {

using motion::Stillness;

constexpr double kLong = 1;  // pixels; with less, a knot that stays is in nobody's way for a while

/// Which knots stay. From those that surely go on, what may do either goes along, ring by ring.
std::vector<bool> resting(const mesh::KnotMesh& mesh, std::span<const Vec2> moves,
                          std::span<const Stillness> stillness) {
  std::vector<bool> rests(moves.size());
  for (std::size_t k = 0; k < rests.size(); ++k) rests[k] = stillness[k] != Stillness::kMoves;
  for (bool any = true; any;) {
    any = false;
    std::vector<std::uint32_t> going(rests.size(), 0);
    std::vector<std::uint32_t> corners(rests.size(), 0);  // of faces, other than the knot itself
    for (const mesh::Face& face : mesh.faces) {
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 1; j < 3; ++j) {
          ++corners[face[i]];
          if (!rests[face[(i + j) % 3]]) ++going[face[i]];
        }
      }
    }
    for (std::size_t k = 0; k < rests.size(); ++k) {
      const bool goes_along = rests[k] && stillness[k] == Stillness::kEither && norm(moves[k]) > kLong &&
                              2 * going[k] >= corners[k];
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
