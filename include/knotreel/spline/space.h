// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/mesh/cut_mesh.h"
#include "knotreel/mesh/knot_mesh.h"

/// TCB-spline spaces over knot meshes (paper sec. 3; docs/algorithm.md).
namespace knotreel::spline {

using mesh::CornerIndex;
using FunctionIndex = std::uint32_t;

inline constexpr int kMaxDegree = 3;
inline constexpr FunctionIndex kNoFunction = 0xffffffffu;

/// A basis function B_I: the multiset I of `degree` corners, ascending; unused places hold kNoCorner.
struct Function {
  std::array<CornerIndex, 3> knots;
};
inline constexpr CornerIndex kNoCorner = 0xffffffffu;

/// A t-config (T, I) of degree k-1, the level from which all degree-k functions are evaluated:
/// B_{I+v}(u) += area(u, edge of T opposite v) * M_{k-1}(u | T + I) for each vertex v of T.
struct Config {
  std::array<CornerIndex, 3> triangle;     ///< T, in positive order (zero area is possible)
  std::array<CornerIndex, 2> inner;        ///< I: degree - 1 corners, the rest kNoCorner
  std::array<FunctionIndex, 3> functions;  ///< B_{I+v} for the three v of T; kNoFunction if it vanishes
};

/// A polygon that has to be triangulated: the link of the vertex J of a t-config family.
struct LinkPolygon {
  std::span<const CornerIndex> vertex;   ///< J: one corner (degree >= 2) or two (degree 3)
  std::span<const CornerIndex> corners;  ///< positive order, starting with the smallest index; size >= 4
  std::span<const Vec2> positions;       ///< of the corners
};

/// Chooses a triangulation of a link: appends the apex codes of the polygon (see link.h). Called once per
/// polygon with four or more corners.
using LinkPolicy = std::function<void(const LinkPolygon&, std::vector<std::uint16_t>& codes)>;

/// How a LinkPolicy is called for the polygons of a level.
enum class LinkOrder : std::uint8_t {
  kFixed,  ///< one after the other, in the order of the space
  kAny,    ///< several at the same time, in any order
};

/// The spline space of one knot mesh: cut mesh, links, t-configs, basis functions. Immutable; all const
/// members may be called from several threads.
class SplineSpace {
 public:
  /// Builds the space with Delaunay-like link triangulations (deterministic).
  /// @param mesh    sound (see mesh::find_defect). @param degree 1, 2 or 3.
  /// @throws Error{kInvalidArgument} for an unsound mesh or a degree out of range.
  SplineSpace(mesh::KnotMesh mesh, int degree);

  /// The same with link triangulations chosen by the caller. @throws Error{kInvalidArgument} also if codes of
  /// the policy do not fit their polygons.
  SplineSpace(mesh::KnotMesh mesh, int degree, const LinkPolicy& policy, LinkOrder order = LinkOrder::kFixed);

  /// The same from stored codes, as link_codes() gave them. Uses no floating-point predicate: equal input
  /// gives the same space on every machine. The mesh must have no topological defect (checked).
  /// @throws Error{kInput} if the codes do not fit the mesh.
  static SplineSpace from_link_codes(mesh::KnotMesh mesh, int degree, std::span<const std::uint16_t> codes);

  /// The same space over the same mesh with its knots elsewhere: all combinatorics, links too, are kept.
  /// @param positions of all knots; knots of segments and sides still on them, ends of segments unmoved.
  SplineSpace moved(std::span<const Vec2> positions) const;

  int degree() const { return degree_; }
  const mesh::KnotMesh& mesh() const { return mesh_; }
  const mesh::CutMesh& cut() const { return cut_; }

  /// Basis functions, ordered lexicographically by their corners.
  std::span<const Function> functions() const { return functions_; }
  std::size_t function_count() const { return functions_.size(); }

  /// Functions with the same geometric knots share one geometry control point: index of that group. Groups
  /// are numbered in the lexicographic order of their sorted knot indices.
  std::span<const std::uint32_t> geometry_of() const { return geometry_of_; }
  /// How many groups there are.
  std::size_t geometry_count() const { return geometry_count_; }

  /// Greville site of a function: the mean of its knots (paper sec. 3.2), in pixels.
  Vec2 greville(FunctionIndex f) const;
  /// Greville sites of the geometry groups.
  std::vector<Vec2> geometry_greville() const;

  /// The family Gamma_{degree-1}.
  std::span<const Config> configs() const { return configs_; }

  /// Triangulation choices of all links with more than three corners, concatenated in the order of the space:
  /// level 1 by corner, then (degree 3) level 2 by pair of corners; see docs/format.md.
  std::span<const std::uint16_t> link_codes() const { return link_codes_; }

  /// Of the knot of a corner, in pixels.
  Vec2 position(CornerIndex c) const { return mesh_.knots[cut_.corners[c].knot].position; }

 private:
  SplineSpace() = default;
  friend class SpaceBuilder;

  int degree_ = 0;
  mesh::KnotMesh mesh_;
  mesh::CutMesh cut_;
  std::vector<Function> functions_;
  std::vector<std::uint32_t> geometry_of_;
  std::size_t geometry_count_ = 0;
  std::vector<Config> configs_;
  std::vector<std::uint16_t> link_codes_;
};

/// Called with a link, its part of link_codes(), and the triangles that these stand for.
using LinkVisitor = std::function<void(const LinkPolygon&, std::span<const std::uint16_t> codes,
                                       std::span<const std::array<std::uint32_t, 3>> triangles)>;

/// Visits all links with more than three corners, in the order of link_codes().
void for_each_link(const SplineSpace& space, const LinkVisitor& visit);

/// T-configs of degree k for one function: triangles of corners such that B_I = sum area(T) M(u | T + I)
/// (paper Eq. 3). Not needed to evaluate; for the reference and for `knotreel dump`.
/// Computed for all functions at once; element f lists the triangles of function f, each in positive order,
/// those of zero area left out.
std::vector<std::vector<std::array<CornerIndex, 3>>> function_triangles(const SplineSpace& space);

}  // namespace knotreel::spline
