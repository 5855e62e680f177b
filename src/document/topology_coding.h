// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "document/arithmetic.h"
#include "document/conquest.h"
#include "document/frame_models.h"
#include "document/frame_state.h"

/// Everything about a frame that is not a position, a link or a control point (docs/format.md, "Topology").
namespace knotreel::document {

/// A mesh without positions.
struct Topology {
  mesh::KnotMesh mesh;  ///< canonical; width, height and positions not set
  std::vector<Discovery> discoveries;
  KnotIndex border_count = 0;
  std::array<KnotIndex, 4> domain_corners{};
  std::vector<std::uint32_t> matches;  ///< with the frame before, see match_knots; kNoMatch in a keyframe
};

/// @param before  null for a keyframe.
void write_topology(const Topology& topology, const FrameState* before, TopologyModels& models,
                    ArithmeticWriter& out);

/// @param most_knots  a frame with more is Malformed: keeps memory in proportion to the file.
/// @return indices are in range, but the mesh may have defects: call mesh::find_defect when it has positions.
Topology read_topology(std::size_t most_knots, const FrameState* before, TopologyModels& models,
                       ArithmeticReader& in);

}  // namespace knotreel::document
