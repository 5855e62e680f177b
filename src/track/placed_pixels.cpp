#include "track/placed_pixels.h"

#include <algorithm>

#include "knotreel/fit/edge_colours.h"
#include "knotreel/fit/geometry_fit.h"

namespace knotreel::track {

namespace {

constexpr int kSteps =
    4;  // the displacement changes by less than a fifth of a pixel per pixel nearly everywhere

/// The displacement at the pixel centres, for looking up anywhere.
class DisplacementGrid {
 public:
  DisplacementGrid(const fit::PixelValues& centres, std::span<const Vec2> displacement)
      : width_(centres.width()), height_(centres.height()) {
    const spline::SplineSpace& space = centres.basis().space();
    std::vector<double> control;
    control.reserve(2 * space.function_count());
    for (const std::uint32_t g : space.geometry_of()) {
      control.push_back(displacement[g].x);
      control.push_back(displacement[g].y);
    }
    offsets_.resize(2 * std::size_t(width_) * std::size_t(height_));
    fit::surface_at_pixels(centres, control, 2, offsets_);
  }

  bool zero(std::size_t pixel) const { return offsets_[2 * pixel] == 0 && offsets_[2 * pixel + 1] == 0; }

  /// Bilinear between pixel centres.
  Vec2 at(Vec2 p) const {
    const double x = std::clamp(p.x - 0.5, 0.0, width_ - 1.0);
    const double y = std::clamp(p.y - 0.5, 0.0, height_ - 1.0);
    const auto x0 = static_cast<std::size_t>(x);
    const auto y0 = static_cast<std::size_t>(y);
    const std::size_t x1 = std::min(x0 + 1, std::size_t(width_) - 1);
    const std::size_t y1 = std::min(y0 + 1, std::size_t(height_) - 1);
    const double fx = x - static_cast<double>(x0);
    const double fy = y - static_cast<double>(y0);
    return (1 - fy) * ((1 - fx) * offset(x0, y0) + fx * offset(x1, y0)) +
           fy * ((1 - fx) * offset(x0, y1) + fx * offset(x1, y1));
  }

 private:
  Vec2 offset(std::size_t x, std::size_t y) const {
    const std::size_t i = 2 * (y * std::size_t(width_) + x);
    return {offsets_[i], offsets_[i + 1]};
  }

  int width_;
  int height_;
  std::vector<double> offsets_;
};

}  // namespace

std::vector<Vec2> rough_places(const spline::Basis& basis, std::span<const Vec2> displacement, int width,
                               int height) {
  const fit::PixelValues centres(basis, width, height, {});
  const DisplacementGrid grid(centres, displacement);
  std::vector<Vec2> places(std::size_t(width) * std::size_t(height));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec2 centre{static_cast<double>(i % std::size_t(width)) + 0.5,
                      static_cast<double>(i / std::size_t(width)) + 0.5};
    places[i] = centre;
    if (grid.zero(i)) continue;
    for (int step = 0; step < kSteps; ++step) places[i] = centre - grid.at(places[i]);
    places[i] = {std::clamp(places[i].x, 0.0, double(width)), std::clamp(places[i].y, 0.0, double(height))};
  }
  return places;
}

PlacedPixels place_pixels(const spline::Basis& basis, std::span<const Vec2> displacement,
                          const image::Image& picture) {
  PlacedPixels placed;
  placed.picture = picture;
  const mesh::KnotMesh& mesh = basis.space().mesh();
  const bool identity =
      std::all_of(displacement.begin(), displacement.end(), [](Vec2 d) { return d == Vec2{}; });
  if (identity && mesh.segments.empty()) return placed;
  const std::vector<Vec2> rough = rough_places(basis, displacement, picture.width, picture.height);
  const fit::PixelValues values(basis, picture.width, picture.height, rough);
  fit::PixelPlaces exact = fit::invert_geometry(values, displacement, rough);
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
