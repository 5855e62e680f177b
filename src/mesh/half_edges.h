// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "knotreel/mesh/knot_mesh.h"

namespace knotreel::mesh {

inline constexpr std::uint32_t kNoHalfEdge = 0xffffffffu;

/// Half edge 3*f + i runs from faces[f][i] to faces[f][(i+1)%3], with face f on its left.
struct HalfEdges {
  std::vector<std::uint32_t> opposite;  ///< kNoHalfEdge on the border

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
};

inline KnotIndex origin(const std::vector<Face>& faces, std::uint32_t h) {
  return faces[h / 3][h % 3];
}
inline KnotIndex target(const std::vector<Face>& faces, std::uint32_t h) {
  return faces[h / 3][(h + 1) % 3];
}

/// All half edges, sorted by (smaller, larger) knot: the two halves of an edge are neighbours.
std::vector<std::uint32_t> sorted_half_edges(const std::vector<Face>& faces);

/// @param order as from sorted_half_edges().
/// @return nothing if an edge has more than two faces or two faces disagree about its direction.
std::optional<HalfEdges> connect_half_edges(const std::vector<Face>& faces,
                                            const std::vector<std::uint32_t>& order);
std::optional<HalfEdges> connect_half_edges(const std::vector<Face>& faces);

}  // namespace knotreel::mesh
