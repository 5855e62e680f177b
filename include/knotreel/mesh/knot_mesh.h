// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "knotreel/base/vec2.h"

/// Knot meshes: the triangulation Gamma_0 of the knots over the parametric domain [0,width] x [0,height],
/// with feature polylines as constrained edges (paper sec. 3.2, 5.4, 6).
namespace knotreel::mesh {

using KnotIndex = std::uint32_t;

/// Name of a knot that survives from frame to frame; unique within a mesh. Indices are not stable, ids are.
enum class KnotId : std::uint32_t {};

enum class KnotKind : std::uint8_t {
  kFree,     ///< simple knot inside the domain, off the features
  kBorder,   ///< simple knot on a side of the domain, one coordinate exactly 0, width or height
  kSegment,  ///< simple knot inside a feature segment
  kVertex,   ///< multiple knot (degree + 1 fold): a domain corner or an end of feature segments
};

struct Knot {
  Vec2 position;  ///< in pixels, inside the closed domain
  KnotKind kind = KnotKind::kFree;
  KnotId id{};
};

/// One straight piece of a feature polyline: its knots in order, first and last of kind kVertex, all others
/// kSegment and on the straight line between them (to rounding). At least one kSegment knot if both ends are
/// open tips (vertices with no other segment and off the border).
struct FeatureSegment {
  std::vector<KnotIndex> knots;
};

/// Three knots in the order of positive signed_area.
using Face = std::array<KnotIndex, 3>;

struct KnotMesh {
  double width = 0;   ///< of the domain, in pixels, > 0
  double height = 0;  ///< of the domain, in pixels, > 0
  std::vector<Knot> knots;
  std::vector<Face> faces;
  std::vector<FeatureSegment> segments;
};

/// Whether a point of the closed domain is on one of its sides.
inline bool on_side(const KnotMesh& mesh, Vec2 p) {
  return p.x <= 0 || p.y <= 0 || p.x >= mesh.width || p.y >= mesh.height;
}

/// Checks everything that the rest of the library relies on: finite positions in the domain, faces that are
/// positively oriented and tile the rectangle (a disk; border knots exactly on their sides; four kVertex
/// knots at the domain corners), unique ids, segments that are edges of the triangulation, kinds that agree
/// with the segments, no face with its three knots on one segment or one side.
/// @return a one-line description of the first defect, or nothing if the mesh is sound. Never throws,
/// whatever the content. O(n log n).
std::optional<std::string> find_defect(const KnotMesh& mesh);

/// Half of find_defect that needs no coordinates: indices in range, every edge in at most two faces and with
/// consistent orientation, one border loop, connected, Euler characteristic of a disk, segments along edges.
/// A reader of documents calls this before it trusts a topology.
std::optional<std::string> find_topological_defect(const KnotMesh& mesh);

/// The other half but for the ids: what can go wrong when the knots of a mesh move. @param mesh without
/// topological defect.
std::optional<std::string> find_geometric_defect(const KnotMesh& mesh);

}  // namespace knotreel::mesh
