// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "features/gradient.h"
#include "knotreel/base/vec2.h"

namespace knotreel::features {

/// Foot of the perpendicular from the pixel's centre to the edge, in image coordinates (of the whole that the
/// field may be a window of); within one pixel of the centre per axis. The centre where there is no edge.
Vec2 refine_position(const GradientField& field, int x, int y);

/// How softly an edge passes from one side to the other at a pixel.
struct Transition {
  double contrast = 0;  ///< levels, from plateau to plateau, at most 4 px away
  double slope = 0;     ///< levels per px: the steepest step in the picture itself, across the edge
};

Transition transition(const GradientField& field, int x, int y);

}  // namespace knotreel::features
