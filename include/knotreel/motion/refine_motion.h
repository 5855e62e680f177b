// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/base/vec2.h"
#include "knotreel/motion/luma.h"

namespace knotreel::motion {

struct RefineMotionOptions {
  int steps = 3;          ///< most of Gauss and Newton for each point, 0 or more
  double stiffness = 20;  ///< squared levels per pixel that texture must have to move a point from the flow
  double most = 1;        ///< farthest from the flow, pixels
};

/// Makes motions that are known to a fraction of a pixel exact [Lucas81]: so that the 8x8 pixels around each
/// point, less their mean, are missed least in the other picture. Where there is no texture along some
/// direction the motion stays as it is along that. Points that do not move are left alone.
/// @param motions of the points, from the picture `from` to `to`.
/// @throws Error{kInvalidArgument} if the pictures differ in size or are empty, or points and motions in
/// number.
/// All threads are used; the result does not depend on their number.
void refine_motion(std::span<const Vec2> points, std::span<Vec2> motions, const Luma& from, const Luma& to,
                   const RefineMotionOptions& options = {});

/// The same for one point, pixel by pixel in double precision; for tests.
Vec2 refined_motion_reference(Vec2 point, Vec2 motion, const Luma& from, const Luma& to,
                              const RefineMotionOptions& options = {});

}  // namespace knotreel::motion
