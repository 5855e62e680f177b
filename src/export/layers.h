// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "export/sheets.h"
#include "knotreel/export/tessellate.h"

/// A picture as layers to be painted one over the other, so that features come out antialiased
/// (docs/export.md, "Layers").
namespace knotreel::exporting {

/// A layer for every face, from 0: faces on the two sides of a feature get different ones, and so do the
/// fans around each knot of a feature. Few layers; the largest regions get the lowest.
std::vector<std::uint32_t> assign_layers(const Sheets& sheets);

/// A narrow strip that a layer paints beyond its faces: in a face of another layer, or outside the picture.
struct Rim {
  /// Of the face painted: along it, or only around its origin. On the border of the picture: of the layer's
  /// own face, and the strip lies outside, for surfaces that do not quite reach the border.
  std::uint32_t half_edge = 0;
  bool along = false;       ///< along the half edge, else around its origin
  bool own_colour = false;  ///< the surface as it is; else the colour of the other side of the feature
  CornerIndex source = 0;   ///< gives the colour around an origin, unless own_colour
  bool shown = false;       ///< the layer's mask lets it through: a later layer paints over it
};

struct Layer {
  /// Faces of other layers, painted first of all: for the first layer, so that no paper shines through,
  /// whatever the shapes of the faces.
  std::vector<std::uint32_t> underlay;
  std::vector<std::uint32_t> faces;  ///< ascending
  std::vector<Rim> rims;             ///< to be painted before the faces
};

std::vector<Layer> make_layers(const Sheets& sheets);

/// Triangles of a rim. Those across features may reach farther than its outline.
Patch rim_patch(const Tessellator& tessellator, const Rim& rim);

/// What a layer may cover: its faces, cut exactly along features, and the rims that are shown. To be filled
/// by the nonzero rule.
std::vector<Loop> layer_outline(const Tessellator& tessellator, const Layer& layer);

}  // namespace knotreel::exporting
