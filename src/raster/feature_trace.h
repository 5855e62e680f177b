// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "raster/pixel_split.h"
#include "raster/surface.h"

namespace knotreel::raster {

struct CrossedPixel {
  int x;
  int y;
  std::optional<PixelParts> parts;  ///< of split_pixel()
};

/// The feature curves in the image: between two neighbouring knots of a segment the trace of the surface's
/// geometry is one polynomial curve of the degree of the surface, kept in Bezier form.
class FeatureTrace {
 public:
  /// @param tiles by tile of spline::PixelTiles: curves that do not come near those with 1 may be left out.
  /// None: there are all.
  FeatureTrace(const Surface& surface, const mesh::KnotMesh& mesh, std::span<const std::uint8_t> tiles = {});

  /// Pixels of a grid that the curves cross, row by row, each once. Curves are followed by chords of half a
  /// pixel, so a pixel whose corner a curve only grazes may be missing.
  /// @param pixel_width, pixel_height of a grid pixel, in pixels of the model.
  std::vector<CrossedPixel> crossed_pixels(double pixel_width, double pixel_height, int row_begin,
                                           int row_end, int column_begin, int column_end) const;

  /// Distance from x to the nearest point of a polyline with `steps` pieces per curve; for the reference
  /// renderer.
  double distance(Vec2 x, int steps) const;

 private:
  struct Curve {
    std::array<Vec2, 4> control;
    int degree;

    Vec2 at(double t) const;
    std::pair<Curve, Curve> halves() const;
  };
  class PixelWalk;

  std::vector<Curve> curves_;
};

}  // namespace knotreel::raster
