// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "knotreel/features/image_mesh.h"
#include "knotreel/param/parametrization.h"

namespace knotreel::param {

/// The image mesh with a ring of vertices on the border of the domain around it, so that its triangles tile
/// the whole domain. Vertices are named by pixel coordinates from -1 to width and height. Ring vertices are
/// opposite their pixels, but for ends of curves, which are where the curve meets the side.
class FramedMesh {
 public:
  using Layout = std::vector<Vec2>;  ///< Parametrization::position or ::parameter

  FramedMesh(const features::ImageMesh& mesh, const Parametrization& parametrization);

  int width() const { return mesh_.width; }
  int height() const { return mesh_.height; }

  Vec2 vertex(const Layout& layout, int x, int y) const {
    const bool inside = x >= 0 && y >= 0 && x < mesh_.width && y < mesh_.height;
    return inside ? layout[pixel(x, y)] : on_ring(x, y);
  }
  /// The vertex itself, or of the ring the pixel next to it.
  std::size_t pixel(int x, int y) const {
    x = x < 0 ? 0 : (x < mesh_.width ? x : mesh_.width - 1);
    y = y < 0 ? 0 : (y < mesh_.height ? y : mesh_.height - 1);
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(mesh_.width) + static_cast<std::size_t>(x);
  }
  bool is_feature(std::size_t pixel_index) const { return is_feature_[pixel_index] != 0; }

  struct Corner {
    int x, y;
  };
  using Triangle = std::array<Corner, 3>;
  /// The two triangles of the square from (x, y) to (x+1, y+1); x and y from -1. Positively oriented at rest.
  std::array<Triangle, 2> triangles(int x, int y) const;

 private:
  Vec2 on_ring(int x, int y) const;

  const features::ImageMesh& mesh_;
  std::vector<std::uint8_t> is_feature_;
  std::array<std::vector<double>, 4> along_;  ///< of ring vertices: left, right (y), top, bottom (x)
};

}  // namespace knotreel::param
