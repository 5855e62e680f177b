// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "param/curves.h"
#include "param/quad.h"
#include "param/tiles.h"

namespace knotreel::param {

/// Places every site on its polyline: vertices where they are, all others by projection (paper sec. 5.4).
/// Fills in vertices, polylines and samples of the result, and Site::parameter.
void assemble_polylines(Curves& curves, Parametrization& result);

/// Makes layouts in which every pixel is at its centre.
void put_layouts_at_rest(const Curves& curves, Parametrization& result);

/// Changes those of the pixels of some tiles: sites exactly, all others by their displacement, with small
/// ones damped to zero (kZero, kKept in the source).
void assemble_layouts(const Curves& curves, const Framed<Quad>& field, const Tiles& tiles,
                      Parametrization& result);

}  // namespace knotreel::param
