// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "knotreel/mesh/knot_mesh.h"
#include "knotreel/track/carry_mesh.h"

namespace knotreel::track {

/// A mesh with the features of a new picture, and between them the free knots of the frame before, where the
/// motion takes them. Knots of features that are where ones of the frame before would be keep their ids, and
/// segments between the same vertices the knots that they had inside.
/// @param features their knots and those of the domain; ids do not matter.
/// @param before   sound. @param targets by knot of it, as knot_targets() gives them.
/// @param next_id  least id of knots to come; goes on.
/// @param options  free knots keep min_distance from features and from each other, or are taken away.
/// @return a sound mesh; nothing if it has a face that is as good as flat, which grids of documents would
/// turn over.
/// @throws Error{kInvalidArgument} if the features make no sound mesh.
std::optional<mesh::KnotMesh> redraw_mesh(const mesh::KnotMesh& features, const mesh::KnotMesh& before,
                                          std::span<const Vec2> targets, const CarryOptions& options,
                                          std::uint32_t& next_id, CarryReport& report);

}  // namespace knotreel::track
