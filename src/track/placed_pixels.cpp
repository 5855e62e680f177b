// SPDX-License-Identifier: GPL-3.0-or-later
#include "track/placed_pixels.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "knotreel/base/parallel.h"
#include "knotreel/fit/edge_colours.h"
#include "knotreel/fit/geometry_fit.h"
#include "knotreel/fit/sharpen_edges.h"
#include "knotreel/spline/surface.h"

namespace knotreel::track {

PlacedPixels placed_pixels(const image::Image& picture, std::shared_ptr<const spline::PlacedBasis> placed,
                           std::span<const std::uint8_t> crossed, double edge_softness) {
  PlacedPixels pixels{picture, {}, std::move(placed)};
  if (crossed.empty()) return pixels;
  fit::sharpen_edges(pixels.picture, crossed, edge_softness);
  const mesh::KnotMesh& mesh = pixels.placed->basis()->space().mesh();
  const std::vector<std::uint8_t> given =
      fit::clear_edge_colours(pixels.picture, pixels.placed->places(), crossed, mesh);
  pixels.weights = fit::edge_weights(crossed, given);
  return pixels;
}

PlacedPixels place_pixels(const std::shared_ptr<const spline::Basis>& basis,
                          std::span<const Vec2> displacement, const image::Image& picture,
                          double edge_softness, const fit::KnownPlaces& known) {
  std::vector<std::uint8_t> crossed;
  std::shared_ptr<const spline::PlacedBasis> placed;
  parallel_invoke([&] { placed = fit::place_basis(basis, displacement, known); },
                  [&] {
                    if (basis->space().mesh().segments.empty()) return;
                    crossed = fit::crossed_pixels(*basis, displacement, picture.width, picture.height);
                  });
  return placed_pixels(picture, std::move(placed), crossed, edge_softness);
}

std::shared_ptr<const spline::PixelSurface> surface_at(const PlacedPixels& pixels,
                                                       std::span<const double> control,
                                                       std::span<const std::uint8_t> kept,
                                                       const spline::PixelSurface* before) {
  auto surface = std::make_shared<spline::PixelSurface>();
  surface->basis = pixels.placed->basis();
  if (!kept.empty()) surface->colours = before->colours;
  surface->colours.resize(pixels.picture.samples.size());
  spline::surface_at_pixels<float>(pixels.placed->values(), {control, pixels.picture.channels},
                                   surface->colours, kept);
  return surface;
}

std::vector<float> residual_of(const PlacedPixels& pixels, const spline::PixelSurface& surface) {
  std::vector<float> residual(surface.colours.size());
  const float* const picture = pixels.picture.samples.data();
  const std::size_t row_size = pixels.picture.row_size();
  parallel_for(static_cast<std::size_t>(pixels.picture.height), [&](std::size_t y) {
    const std::size_t first = y * row_size;
    std::transform(picture + first, picture + first + row_size, surface.colours.data() + first,
                   residual.data() + first, std::minus());
  });
  return residual;
}

}  // namespace knotreel::track
