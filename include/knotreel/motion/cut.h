// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "knotreel/base/error.h"
#include "knotreel/motion/luma.h"

namespace knotreel::motion {

/// How little texture is kept from one picture to the next, 0 (all of it, or there is none) to 1 (nothing):
/// one minus the correlation, within blocks, of luma averaged over a few pixels. Light hardly shows, nor does
/// noise.
/// @param before a picture. @param moved the next one seen from its place: warp() along the flow.
/// @throws Error{kInvalidArgument} if sizes differ or a picture is empty.
/// All threads are used; the result does not depend on their number.
double unlikeness(const Luma& before, const Luma& moved);

struct CutOptions {
  double threshold = 0.4;  ///< least unlikeness of a cut; 1 or more: nothing is one
};

/// Whether a new scene begins with the second picture. Meant for hard cuts: fades, moving cameras and light
/// that changes are one scene. Pictures without texture are all alike.
bool is_cut(double unlikeness, const CutOptions& options = {});

}  // namespace knotreel::motion
