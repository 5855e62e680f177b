// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "param/curves.h"
#include "param/framed_mesh.h"
#include "param/tiles.h"

namespace knotreel::param {

/// A triangle of the framed image mesh that is turned over or all but flat.
struct Fold {
  int x = 0;  ///< of its square
  int y = 0;
  bool in_parameter = false;  ///< else in the position layout
};

/// Folds of both layouts, by rows. Triangles of three feature pixels may be flat, since all three may lie on
/// one straight segment.
/// @param tiles of pixels: squares that begin in others are not looked at, but at the border all are.
std::vector<Fold> find_folds(const FramedMesh& mesh, const Parametrization& parametrization,
                             const Tiles& tiles);

/// Changes the curves near folds so that the next solution has fewer: first by splitting segments (parameter)
/// or relaxing the fairing (position), after kGentleRounds rounds by falling back to the chain of pixel
/// centres itself within a radius that doubles each time and at last covers the picture. That layout is the
/// identity and has no folds, so repairing ends.
void repair_folds(Curves& curves, const std::vector<Fold>& folds, int round);

}  // namespace knotreel::param
