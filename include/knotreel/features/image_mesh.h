// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/features/chains.h"

namespace knotreel::features {

/// The image mesh (paper sec. 4, 5.2): a vertex per pixel, two triangles per square of four pixels, and the
/// diagonals flipped so that each step of a feature chain is an edge.
struct ImageMesh {
  int width = 0;
  int height = 0;
  /// For the square with corners (x, y) .. (x+1, y+1), at y * (width - 1) + x: 0 if its diagonal joins (x, y)
  /// and (x+1, y+1), 1 if it joins (x+1, y) and (x, y+1).
  std::vector<std::uint8_t> diagonals;
};

/// Squares without a diagonal step of a chain get 0.
ImageMesh make_image_mesh(const FeatureChains& chains);

}  // namespace knotreel::features
