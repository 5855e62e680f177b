// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "document/conquest.h"
#include "document/frame_state.h"

/// From any numbering of a model to the one of the file (docs/format.md, "Canonical order").
namespace knotreel::document {

/// A mesh in canonical numbering; positions and ids as given.
struct CanonicalMesh {
  mesh::KnotMesh mesh;
  Conquest conquest;
  KnotIndex border_count = 0;
  std::array<KnotIndex, 4> domain_corners{};
  std::vector<KnotIndex> knot_of;      ///< canonical -> given
  std::vector<std::uint32_t> face_of;  ///< canonical -> given
};

/// @param mesh  sound. @throws Error{kInvalidArgument} if it is not a disk over its rectangle.
CanonicalMesh canonical_mesh(const mesh::KnotMesh& mesh);

/// Corner of the given cut mesh -> corner of the canonical one.
std::vector<mesh::CornerIndex> corner_map(const mesh::CutMesh& given, const mesh::CutMesh& canonical,
                                          const CanonicalMesh& numbering);

/// The space over the canonical mesh `mesh` (whose positions may have been quantised) with the link
/// triangulations of `given`; `given` itself if it is that.
std::shared_ptr<const spline::SplineSpace> canonical_space(
    const std::shared_ptr<const spline::SplineSpace>& given, mesh::KnotMesh mesh,
    const CanonicalMesh& numbering);

/// Function of the canonical space -> function of the given one.
/// @throws Error{kInternal} if the spaces do not correspond.
std::vector<spline::FunctionIndex> function_map(const spline::SplineSpace& given,
                                                const spline::SplineSpace& canonical,
                                                const CanonicalMesh& numbering);

}  // namespace knotreel::document
