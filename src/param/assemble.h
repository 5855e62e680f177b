// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "param/curves.h"
#include "param/quad.h"

namespace knotreel::param {

/// Places every site on its polyline: vertices where they are, all others by projection (paper sec. 5.4).
/// Fills in vertices, polylines and samples of the result, and Site::parameter.
void assemble_polylines(Curves& curves, Parametrization& result);

/// Fills in the layouts of the pixels: sites exactly, all others by their displacement, with small ones
/// damped to zero (kZero, kKept in the source).
void assemble_layouts(const Curves& curves, const Framed<Quad>& field, Parametrization& result);

}  // namespace knotreel::param
