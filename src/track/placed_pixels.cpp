#include "track/placed_pixels.h"

#include <algorithm>

#include "knotreel/fit/edge_colours.h"
#include "knotreel/fit/geometry_fit.h"

namespace knotreel::track {

PlacedPixels place_pixels(const spline::Basis& basis, std::span<const Vec2> displacement,
                          const image::Image& picture) {
  PlacedPixels placed;
  placed.picture = picture;
  const mesh::KnotMesh& mesh = basis.space().mesh();
  const bool identity =
      std::all_of(displacement.begin(), displacement.end(), [](Vec2 d) { return d == Vec2{}; });
  if (identity && mesh.segments.empty()) return placed;
  const fit::PixelValues centres(basis, picture.width, picture.height, {});
  fit::PixelPlaces exact = fit::invert_geometry(centres, displacement, {});
  placed.places = std::move(exact.places);
  const std::vector<std::uint8_t> given =
      fit::clear_edge_colours(placed.picture, placed.places, exact.crossed, mesh);
  placed.weights.resize(placed.places.size());
  for (std::size_t i = 0; i < placed.weights.size(); ++i) {
    placed.weights[i] = !exact.crossed[i] ? 1.0F : given[i] ? fit::kEdgeWeight : 0.0F;
  }
  return placed;
}

}  // namespace knotreel::track
