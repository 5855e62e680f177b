// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "document/edge_table.h"
#include "knotreel/mesh/knot_mesh.h"

/// Connectivity of a knot mesh as a short string of symbols (docs/format.md, "Connectivity"): the border loop
/// closes in on the interior, one face per step, always at a *gate*, the edge of the loop that is next. The
/// same steps number the knots, so that the numbering depends on the topology alone.
///
/// After the cut-border machine [Gumhold98] and edgebreaker [Rossignac99], with the border given and the
/// offset of a split explicit.
namespace knotreel::document {

using mesh::Face;
using mesh::KnotIndex;

inline constexpr KnotIndex kNoKnot = 0xffffffffu;

/// What the face at the gate (a,b) finds at its third corner x.
enum class Step : std::uint8_t {
  kNew = 0,    ///< a knot not seen before; the loop grows by one
  kRight = 1,  ///< the knot after b on the loop; b is done, or the whole loop if it had three knots
  kLeft = 2,   ///< the knot before a on the loop; a is done
  kSplit = 3,  ///< another knot of the loop, which falls into two
};

/// Gate at which a knot was found, and the third knot of the face behind that gate (kNoKnot at the border).
struct Discovery {
  KnotIndex a;
  KnotIndex b;
  KnotIndex behind;
};

/// A mesh in canonical numbering: knots 0 to border - 1 are the border loop from the top left corner on in
/// positive order, the others follow as they are found, faces in the order of the steps.
struct Conquest {
  std::vector<Face> faces;             ///< canonical indices
  std::vector<Discovery> discoveries;  ///< of knot border + i
};

/// The conquest of a mesh and the map to it.
struct Conquered {
  Conquest conquest;
  std::vector<KnotIndex> knot_of;      ///< canonical -> given index
  std::vector<std::uint32_t> face_of;  ///< canonical -> given index
};

/// @param edges  of the mesh. @param border  the border loop in given indices.
/// @throws Malformed if the mesh is not a disk with that border.
Conquered conquer(const EdgeTable& edges, const std::vector<KnotIndex>& border);

/// The loops that are still open, as linked nodes; shared by both directions.
class Loops {
 public:
  explicit Loops(std::size_t border_count);

  bool done() const { return stack_.empty(); }
  std::size_t length() const { return stack_.back().length; }
  /// Knots of the gate (a,b), before a, and after b.
  KnotIndex a() const { return nodes_[gate_a()].knot; }
  KnotIndex b() const { return nodes_[gate_b()].knot; }
  KnotIndex before() const { return nodes_[nodes_[gate_a()].previous].knot; }
  KnotIndex after() const { return nodes_[nodes_[gate_b()].next].knot; }
  KnotIndex behind() const { return nodes_[gate_a()].behind; }

  // Each takes the face at the gate off the open region and moves to the next gate.
  void found(KnotIndex x);
  void right();
  void left();
  /// @param code  2 s when x is s + 2 steps after b, 2 s + 1 when it is s + 2 steps before a.
  /// @return x. @throws Malformed if there is no such knot.
  KnotIndex split(std::uint64_t code);

  /// The code of split() for a knot on the loop, or Malformed.
  std::uint64_t split_code(KnotIndex x) const;

 private:
  struct Node {
    KnotIndex knot;
    std::uint32_t next;
    std::uint32_t previous;
    KnotIndex behind;  ///< of the edge to the next node
  };
  struct Open {
    std::uint32_t gate;  ///< node of a
    std::size_t length;
  };

  std::uint32_t gate_a() const { return stack_.back().gate; }
  std::uint32_t gate_b() const { return nodes_[stack_.back().gate].next; }

  std::vector<Node> nodes_;
  std::vector<Open> stack_;
};

}  // namespace knotreel::document
