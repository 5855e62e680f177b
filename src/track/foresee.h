#pragma once

#include <cstddef>
#include <vector>

#include "knotreel/knots/target.h"
#include "knotreel/mesh/editable_mesh.h"

namespace knotreel::track {

/// Puts knots where a new picture has what the one before had not, before anything is fitted: in the faces
/// whose best linear approximation has become worse most, one each.
/// @param mesh    of the new picture. @param before, target_before  the mesh that it comes from, and its
/// picture.
/// @param count   most knots to insert.
/// @return the new knots.
std::vector<mesh::KnotIndex> insert_foreseen(mesh::EditableMesh& mesh, const knots::Target& target,
                                             const mesh::KnotMesh& before, const knots::Target& target_before,
                                             std::size_t count, double min_distance);

}  // namespace knotreel::track
