// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/mesh/knot_mesh.h"

namespace knotreel::mesh {

using FaceIndex = std::uint32_t;
inline constexpr FaceIndex kNoFace = 0xffffffffu;
inline constexpr KnotIndex kNoKnot = 0xffffffffu;
inline constexpr std::uint32_t kNoSegment = 0xffffffffu;

/// A knot mesh under construction: knots can be inserted, moved and removed, edges flipped. Every operation
/// keeps the triangulation sound (positive faces, features and border in place). Knot indices and face
/// indices stay valid until the knot or face is removed; freed places are used again, faces by insertion,
/// knots not. Not thread safe for writing, but for move() of knots that are no neighbours; const members may
/// be called from several threads.
class EditableMesh {
 public:
  /// An edge as seen from one of its faces: the one opposite corner `side` of `face`.
  struct Edge {
    FaceIndex face;
    int side;
  };

  /// @param mesh sound and triangulated. @param first_new_id least id of knots to come: names of knots that
  /// were removed earlier are not used again.
  explicit EditableMesh(const KnotMesh& mesh, std::uint32_t first_new_id = 0);

  /// Id of the next new knot.
  std::uint32_t next_id() const { return next_id_; }

  /// The mesh without the gaps that removals left; ids are kept, faces are in canonical order.
  KnotMesh to_mesh() const;

  // Indices that are asked for must be below knot_slots() and face_slots(), and but for is_knot() and
  // is_face() those of knots and faces that are there; nothing is checked.

  double width() const { return width_; }
  double height() const { return height_; }
  /// Places for knots, removed ones included.
  std::size_t knot_slots() const { return knots_.size(); }
  std::size_t knot_count() const { return knots_.size() - removed_knots_; }
  std::size_t face_slots() const { return faces_.size(); }
  std::size_t face_count() const { return faces_.size() - free_faces_.size(); }
  bool is_knot(KnotIndex k) const { return face_of_[k] != kNoFace; }
  bool is_face(FaceIndex f) const { return faces_[f][0] != kNoKnot; }

  const std::vector<FeatureSegment>& segments() const { return segments_; }
  const Knot& knot(KnotIndex k) const { return knots_[k]; }
  Vec2 position(KnotIndex k) const { return knots_[k].position; }
  const Face& face(FaceIndex f) const { return faces_[f]; }
  std::array<Vec2, 3> triangle(FaceIndex f) const {
    const Face& v = faces_[f];
    return {position(v[0]), position(v[1]), position(v[2])};
  }
  /// The corner of a face at which one of its knots is.
  std::size_t corner_of(FaceIndex f, KnotIndex k) const {
    const Face& v = faces_[f];
    return v[0] == k ? 0 : v[1] == k ? 1 : 2;
  }
  /// The face across the edge opposite corner i; kNoFace on the border.
  FaceIndex neighbour(FaceIndex f, int i) const { return neighbours_[f][static_cast<std::size_t>(i)]; }
  /// The feature segment along the edge opposite corner i, or kNoSegment.
  std::uint32_t segment(FaceIndex f, int i) const { return segments_of_[f][static_cast<std::size_t>(i)]; }
  /// On the border or on a feature: must stay.
  bool is_fixed(Edge e) const {
    return neighbour(e.face, e.side) == kNoFace || segment(e.face, e.side) != kNoSegment;
  }
  /// The same edge from its other face; only for edges off the border.
  Edge mirror(Edge e) const;

  /// The edge between two knots that are neighbours.
  Edge edge_between(KnotIndex a, KnotIndex b) const;
  /// Faces around a knot, in positive order; for a knot on the border, from one side to the other.
  void faces_around(KnotIndex k, std::vector<FaceIndex>& out) const;

  /// A new free knot strictly inside a face, which is split in three. Connectivity is left so.
  KnotIndex insert_in_face(FaceIndex f, Vec2 position);
  /// A new knot on an edge, whose one or two faces are split: of kind kFree on a plain edge, kBorder on the
  /// border (position is put exactly on the side) and kSegment on a feature. The position must be between the
  /// end points and (but for rounding) on the edge.
  KnotIndex insert_on_edge(Edge e, Vec2 position);
  /// Whether the edge may be flipped: not fixed, and its two faces form a strictly convex quadrilateral.
  bool can_flip(Edge e) const;
  /// Flips an edge that can_flip(). Afterwards it is the edge between the same two faces; the one returned.
  Edge flip(Edge e);
  /// Makes an edge off the border and off the features a feature segment; its ends become kVertex knots.
  /// @param a, b neighbours, of kind kFree or kVertex.
  void make_segment(KnotIndex a, KnotIndex b);
  /// Flips edges until all that may be flipped near the knot are locally Delaunay again (Lawson), after its
  /// insertion into a mesh that was.
  void legalise_around(KnotIndex k);
  /// Moves a free, border or segment knot if all its faces stay positive; border and segment knots must be
  /// moved along their line (the position is projected onto it).
  /// @return whether it was moved.
  bool move(KnotIndex k, Vec2 position);
  /// Removes a free knot, or one of kind kBorder, and closes the hole.
  /// @return whether that was possible; if not, the mesh is as it was.
  bool remove(KnotIndex k);
  /// Where a move to `target` would put the knot: itself, or its projection onto the line of the knot.
  Vec2 projected(KnotIndex k, Vec2 target) const;

 private:
  void set_face(FaceIndex f, const Face& v, const std::array<FaceIndex, 3>& n,
                const std::array<std::uint32_t, 3>& s);
  void replace_neighbour(FaceIndex f, FaceIndex from, FaceIndex to);
  FaceIndex new_face();
  KnotIndex new_knot(Vec2 position, KnotKind kind);
  std::array<KnotIndex, 2> line_neighbours(KnotIndex k) const;
  /// Flips edges at a knot until it has so many faces. @return whether that was possible; if not, nothing has
  /// changed.
  bool flip_to_degree(KnotIndex k, std::size_t faces);
  /// @param edges that flips made, in their order.
  void undo_flips(std::span<const std::array<KnotIndex, 2>> edges);

  double width_ = 0;
  double height_ = 0;
  std::vector<Knot> knots_;
  std::vector<FaceIndex> face_of_;  ///< a face of each knot; kNoFace if removed
  std::vector<Face> faces_;
  std::vector<std::array<FaceIndex, 3>> neighbours_;
  std::vector<std::array<std::uint32_t, 3>> segments_of_;
  std::vector<FaceIndex> free_faces_;
  std::vector<FeatureSegment> segments_;
  std::size_t removed_knots_ = 0;
  std::uint32_t next_id_ = 0;
};

}  // namespace knotreel::mesh
