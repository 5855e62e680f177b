// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/document/frame_model.h"

namespace knotreel::track {

/// A frame between two frames of one group: on the mesh of the nearer one, with the knots, displacements and
/// colours that both have (by the ids of the knots) on the straight way from one to the other. Knots that
/// only the nearer frame has go along with their neighbours, faces that would turn over move as a whole, and
/// control points that only it has stay as they are. If faces turn over all the same, the nearer frame as
/// it is.
/// @param share  of the way from `before` (0, exactly that frame) to `after` (1, exactly that one); at a half
///   `after` is the nearer one.
/// @throws Error{kInvalidArgument} for models with a defect (document::find_defect()), models that differ in
/// size, degree or channels, or another share.
document::FrameModel between(const document::FrameModel& before, const document::FrameModel& after,
                             double share);

}  // namespace knotreel::track
