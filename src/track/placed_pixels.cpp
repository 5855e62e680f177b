#include "track/placed_pixels.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "knotreel/base/parallel.h"
#include "knotreel/fit/edge_colours.h"
#include "knotreel/fit/geometry_fit.h"

namespace knotreel::track {

namespace {

// The displacement changes by less than a fifth of a pixel per pixel nearly everywhere, so each step leaves
// less than a fifth of the way.
constexpr int kSteps = 4;
constexpr double kShortStep = 0.02;  // pixels; the last one

Vec2 centre_of(std::size_t pixel, int width) {
  return {static_cast<double>(pixel % std::size_t(width)) + 0.5,
          static_cast<double>(pixel / std::size_t(width)) + 0.5};
}

/// The displacement at the pixel centres, for looking up anywhere.
class DisplacementGrid {
 public:
  DisplacementGrid(const spline::Basis& basis, std::span<const Vec2> displacement, int width, int height)
      : width_(width), height_(height) {
    const spline::SplineSpace& space = basis.space();
    std::vector<double> control;
    control.reserve(2 * space.function_count());
    std::vector<std::uint8_t> displaced;  // few: those near features
    displaced.reserve(space.function_count());
    for (const std::uint32_t g : space.geometry_of()) {
      control.push_back(displacement[g].x);
      control.push_back(displacement[g].y);
      displaced.push_back(displacement[g] != Vec2{});
    }
    offsets_.resize(2 * std::size_t(width_) * std::size_t(height_));
    spline::surface_at_pixels(spline::PixelValues(basis, width, height, {}, displaced), control, 2, offsets_);
  }

  bool zero(std::size_t pixel) const { return of(pixel) == Vec2{}; }
  Vec2 of(std::size_t pixel) const { return {offsets_[2 * pixel], offsets_[2 * pixel + 1]}; }

  /// Bilinear between pixel centres.
  Vec2 at(Vec2 p) const {
    const double x = std::clamp(p.x - 0.5, 0.0, width_ - 1.0);
    const double y = std::clamp(p.y - 0.5, 0.0, height_ - 1.0);
    const int x0 = static_cast<int>(x);
    const int y0 = static_cast<int>(y);
    const int x1 = std::min(x0 + 1, width_ - 1);
    const int y1 = std::min(y0 + 1, height_ - 1);
    const double fx = x - static_cast<double>(x0);
    const double fy = y - static_cast<double>(y0);
    return (1 - fy) * ((1 - fx) * offset(x0, y0) + fx * offset(x1, y0)) +
           fy * ((1 - fx) * offset(x0, y1) + fx * offset(x1, y1));
  }

 private:
  Vec2 offset(int x, int y) const { return of(std::size_t(y) * std::size_t(width_) + std::size_t(x)); }

  int width_;
  int height_;
  std::vector<double> offsets_;
};

/// Places of the pixels but for a few hundredths of a pixel next to features, where the displacement bends.
std::vector<Vec2> rough_places(const spline::Basis& basis, std::span<const Vec2> displacement, int width,
                               int height) {
  const DisplacementGrid grid(basis, displacement, width, height);
  std::vector<Vec2> places(std::size_t(width) * std::size_t(height));
  parallel_for(static_cast<std::size_t>(height), [&](std::size_t y) {
    for (std::size_t x = 0; x < std::size_t(width); ++x) {
      const std::size_t i = y * std::size_t(width) + x;
      const Vec2 centre{static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5};
      places[i] = centre;
      if (grid.zero(i)) continue;
      places[i] = centre - grid.of(i);
      for (int step = 1; step < kSteps; ++step) {
        const Vec2 next = centre - grid.at(places[i]);
        const Vec2 far = next - places[i];
        places[i] = next;
        if (std::abs(far.x) < kShortStep && std::abs(far.y) < kShortStep) break;
      }
      places[i] = {std::clamp(places[i].x, 0.0, double(width)), std::clamp(places[i].y, 0.0, double(height))};
    }
  });
  return places;
}

/// Another step of the iteration, with the geometry itself, for pixels on features and next to them.
void correct_near(const std::vector<std::uint8_t>& crossed, const spline::Basis& basis,
                  std::span<const Vec2> displacement, int width, int height, std::vector<Vec2>& places) {
  std::vector<std::uint8_t> beside(crossed.size(), 0);
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    if (!crossed[i]) continue;
    const int x = static_cast<int>(i % std::size_t(width));
    const int y = static_cast<int>(i / std::size_t(width));
    for (int v = std::max(0, y - 1); v <= std::min(height - 1, y + 1); ++v) {
      for (int u = std::max(0, x - 1); u <= std::min(width - 1, x + 1); ++u) {
        beside[std::size_t(v) * std::size_t(width) + std::size_t(u)] = 1;
      }
    }
  }
  std::vector<std::size_t> near;
  std::vector<Vec2> before;
  for (std::size_t i = 0; i < beside.size(); ++i) {
    if (!beside[i]) continue;
    near.push_back(i);
    before.push_back(places[i]);
  }
  const std::vector<Vec2> after = fit::image_points(basis, displacement, before);
  for (std::size_t k = 0; k < near.size(); ++k) {
    const Vec2 p = before[k] + (centre_of(near[k], width) - after[k]);
    places[near[k]] = {std::clamp(p.x, 0.0, double(width)), std::clamp(p.y, 0.0, double(height))};
  }
}

}  // namespace

PlacedPixels placed_pixels(const image::Image& picture, const mesh::KnotMesh& mesh, std::vector<Vec2> places,
                           std::span<const std::uint8_t> crossed) {
  PlacedPixels placed{picture, {}, std::move(places)};
  if (crossed.empty()) return placed;
  const std::vector<std::uint8_t> given =
      fit::clear_edge_colours(placed.picture, placed.places, crossed, mesh);
  placed.weights.resize(crossed.size());
  for (std::size_t i = 0; i < crossed.size(); ++i) {
    placed.weights[i] = !crossed[i] ? 1.0F : given[i] ? fit::kEdgeWeight : 0.0F;
  }
  return placed;
}

PlacedPixels place_pixels(const spline::Basis& basis, std::span<const Vec2> displacement,
                          const image::Image& picture) {
  const mesh::KnotMesh& mesh = basis.space().mesh();
  const bool identity =
      std::all_of(displacement.begin(), displacement.end(), [](Vec2 d) { return d == Vec2{}; });
  if (identity && mesh.segments.empty()) return placed_pixels(picture, mesh, {}, {});
  const std::vector<std::uint8_t> crossed =
      fit::crossed_pixels(basis, displacement, picture.width, picture.height);
  std::vector<Vec2> places = rough_places(basis, displacement, picture.width, picture.height);
  correct_near(crossed, basis, displacement, picture.width, picture.height, places);
  return placed_pixels(picture, mesh, std::move(places), crossed);
}

}  // namespace knotreel::track
