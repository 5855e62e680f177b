#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "document/bytes.h"
#include "document/conquest.h"
#include "document/frame_state.h"
#include "document/streams.h"

/// Everything about a frame that is not a position or a control point (docs/format.md, "Topology").
namespace knotreel::document {

/// A mesh without positions, and the choices in its links.
struct Topology {
  mesh::KnotMesh mesh;  ///< canonical; width, height and positions not set
  std::vector<Discovery> discoveries;
  KnotIndex border_count = 0;
  std::array<KnotIndex, 4> domain_corners{};
  std::vector<std::uint16_t> link_codes;
};

/// @param knots_before  of the frame before, null for a keyframe: ids refer to them.
void write_topology(const mesh::KnotMesh& mesh, const Conquest& conquest,
                    const std::array<KnotIndex, 4>& domain_corners,
                    const std::vector<std::uint16_t>& link_codes, const mesh::KnotMesh* knots_before,
                    StreamWriter& streams, ByteWriter& out);

/// @param most_knots  a frame with more is Malformed: keeps memory in proportion to the file.
/// @return indices are in range, but the mesh may have defects: call mesh::find_defect when it has positions.
Topology read_topology(std::size_t most_knots, const mesh::KnotMesh* knots_before, StreamReader& streams,
                       ByteReader& in);

}  // namespace knotreel::document
