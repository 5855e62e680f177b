#pragma once

#include <cstdint>
#include <vector>

#include "knotreel/base/vec2.h"
#include "knotreel/features/chains.h"
#include "knotreel/features/image_mesh.h"
#include "knotreel/image/image.h"

/// The map between picture and parametric domain (paper sec. 5.2, 5.4). The domain is [0,width] x [0,height]
/// in pixels, and the map is the identity but for a small displacement.
namespace knotreel::param {

/// Where a vertex of a feature polyline lies; on a side of the domain one coordinate is exactly 0, width or
/// height.
enum class VertexPlace : std::uint8_t { kInside, kLeft, kRight, kTop, kBottom };

struct PolylineVertex {
  Vec2 position;  ///< in the parametric domain
  VertexPlace place = VertexPlace::kInside;
};

/// A chain simplified to straight pieces in the parametric domain.
struct Polyline {
  std::uint32_t chain = 0;              ///< index in FeatureChains::chains
  std::vector<std::uint32_t> vertices;  ///< in order of the chain; of a closed one, the first is not repeated
  bool closed = false;
};

/// A point of a feature curve with its place on the polyline.
struct CurveSample {
  std::uint32_t polyline = 0;
  std::uint32_t segment = 0;  ///< from vertices[segment] to the next one
  double t = 0;               ///< in [0, 1] along the segment; grows along the chain
  Vec2 position;              ///< in image coordinates
};

struct Parametrization {
  int width = 0;
  int height = 0;
  std::vector<PolylineVertex> vertices;  ///< those of nodes are shared between polylines
  std::vector<Polyline> polylines;
  std::vector<CurveSample>
      curve_samples;  ///< of all points of all chains (and their ends on the border), in order

  /// Of each pixel: its faired position in the image, and where that is in the parametric domain. Feature
  /// pixels lie on their curve and on their polyline.
  std::vector<Vec2> position;
  std::vector<Vec2> parameter;
};

}  // namespace knotreel::param
