// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/surface.h"

#include <algorithm>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "spline/jet.h"
#include "spline/tile_terms.h"

namespace knotreel::spline {

namespace {

constexpr std::size_t kPoints = 256;  // of one call of a parallel loop

void check_control(const Basis& basis, const Control& control) {
  const bool fits =
      control.channels >= 1 && control.channels <= kMaxSurfaceChannels &&
      control.points.size() == basis.space().function_count() * static_cast<std::size_t>(control.channels);
  if (!fits)
    throw Error(ErrorKind::kInvalidArgument, "the control points of a surface are not one per function");
}

void add(Plane& sum, double weight, const Plane& p) {
  sum = {sum.c + weight * p.c, sum.x + weight * p.x, sum.y + weight * p.y};
}

/// Calls visit(k, control point) for the functions of a piece that there are.
template <class Visit>
void for_functions(const Piece& piece, const Control& control, Visit&& visit) {
  const auto channels = static_cast<std::size_t>(control.channels);
  for (std::size_t k = 0; k < 3; ++k) {
    if (piece.functions[k] == kNoFunction) continue;
    visit(k, control.points.data() + piece.functions[k] * channels);
  }
}

/// What terms of a piece are multiplied by, for each channel.
std::array<Plane, kMaxSurfaceChannels> planes_of(const Piece& piece, const Control& control, Vec2 origin) {
  std::array<Plane, kMaxSurfaceChannels> planes{};
  for_functions(piece, control, [&](std::size_t k, const double* point) {
    const Plane weight = plane_of(piece.weights[k], origin);
    for (std::size_t c = 0; c < static_cast<std::size_t>(control.channels); ++c)
      add(planes[c], point[c], weight);
  });
  return planes;
}

/// The surface at the places of a tile.
template <class Value>
void add_up(const PixelTiles& tiles, std::size_t tile, const Control& control, TilePlaces<Value>& places,
            TileSurface<Value>& out) {
  const auto channels = static_cast<std::size_t>(control.channels);
  out.fill(0);
  const PieceSet& set = tiles.basis().pieces();
  for (const std::uint32_t p : tiles.pieces(tile)) {
    const auto planes = planes_of(set.pieces[p], control, places.origin());
    std::array<Share<Value>, kMaxSurfaceChannels> shares;
    for (std::size_t c = 0; c < channels; ++c)
      shares[c] = {plane_in<Value>(planes[c]), out.data() + c * kPixels};
    places.add(set, set.pieces[p], std::span(shares).first(channels), false);
  }
}

/// By piece: whether some control point of its functions is not zero.
std::vector<std::uint8_t> counting_pieces(const PieceSet& set, const Control& control) {
  std::vector<std::uint8_t> counts(set.pieces.size(), 0);
  for (std::size_t p = 0; p < counts.size(); ++p) {
    for_functions(set.pieces[p], control, [&](std::size_t, const double* point) {
      if (std::any_of(point, point + control.channels, [](double v) { return v != 0; })) counts[p] = 1;
    });
  }
  return counts;
}

}  // namespace

template <class Value>
void surface_of_tile(const PixelTiles& tiles, std::size_t tile, const Control& control,
                     TileSurface<Value>& out) {
  TilePlaces<Value> places(tiles, tile);
  add_up(tiles, tile, control, places, out);
}

template void surface_of_tile(const PixelTiles&, std::size_t, const Control&, TileSurface<double>&);
template void surface_of_tile(const PixelTiles&, std::size_t, const Control&, TileSurface<float>&);

template <class Value>
void surface_of_tile(const PixelTiles& tiles, std::size_t tile, std::span<const Vec2, kPixels> places,
                     const Control& control, TileSurface<Value>& out) {
  TilePlaces<Value> others(tiles, tile, places);
  add_up(tiles, tile, control, others, out);
}

template void surface_of_tile(const PixelTiles&, std::size_t, std::span<const Vec2, kPixels>, const Control&,
                              TileSurface<float>&);

template <class Value>
void for_surface_tiles(const PixelTiles& tiles, const Control& control,
                       const std::function<void(std::size_t, const TileSurface<Value>&)>& visit,
                       std::span<const std::uint8_t> skipped) {
  const std::size_t columns = tiles.tile_columns();
  parallel_for(tiles.tile_rows(), [&](std::size_t row) {
    alignas(64) TileSurface<Value> surface;
    for (std::size_t t = row * columns; t < (row + 1) * columns; ++t) {
      if (!skipped.empty() && skipped[t]) continue;
      surface_of_tile(tiles, t, control, surface);
      visit(t, surface);
    }
  });
}

template void for_surface_tiles(const PixelTiles&, const Control&,
                                const std::function<void(std::size_t, const TileSurface<double>&)>&,
                                std::span<const std::uint8_t>);
template void for_surface_tiles(const PixelTiles&, const Control&,
                                const std::function<void(std::size_t, const TileSurface<float>&)>&,
                                std::span<const std::uint8_t>);

template <class Value>
void surface_at_pixels(const PixelTiles& tiles, const Control& control, std::span<Value> out,
                       std::span<const std::uint8_t> skipped) {
  const auto channels = static_cast<std::size_t>(control.channels);
  const auto store = [&](std::size_t t, const TileSurface<Value>& surface) {
    tiles.for_pixels(t, [&](std::size_t pixel, std::size_t place) {
      for (std::size_t c = 0; c < channels; ++c) out[pixel * channels + c] = surface[c * kPixels + place];
    });
  };
  for_surface_tiles<Value>(tiles, control, store, skipped);
}

template void surface_at_pixels(const PixelTiles&, const Control&, std::span<double>,
                                std::span<const std::uint8_t>);
template void surface_at_pixels(const PixelTiles&, const Control&, std::span<float>,
                                std::span<const std::uint8_t>);

void surface_at_points(const Basis& basis, const Control& control, std::span<const Vec2> points,
                       std::span<double> out) {
  check_control(basis, control);
  const auto channels = static_cast<std::size_t>(control.channels);
  if (out.size() != channels * points.size())
    throw Error(ErrorKind::kInvalidArgument, "there is not as much room as the points have values");
  const PieceSet& set = basis.pieces();
  const mesh::KnotMesh& mesh = basis.space().mesh();
  const TermIndex& index = basis.index();
  // Displacements are zero in most of a picture.
  const std::vector<std::uint8_t> counts = counting_pieces(set, control);
  parallel_for((points.size() + kPoints - 1) / kPoints, [&](std::size_t block) {
    for (std::size_t i = block * kPoints; i < std::min(points.size(), (block + 1) * kPoints); ++i) {
      const Vec2 u = points[i];
      const Vec2 direction = inward_direction(u, mesh.width, mesh.height);
      double* const sums = out.data() + i * channels;
      std::fill_n(sums, channels, 0.0);
      for (const TermIndex::Entry& e : index.at(u)) {
        if (!counts[e.piece] || !index.near(e, u)) continue;
        const double w = term_value(set.terms[e.term], u, direction);
        if (w == 0) continue;
        for_functions(set.pieces[e.piece], control, [&](std::size_t k, const double* point) {
          const double weight = w * set.pieces[e.piece].weights[k](u);
          for (std::size_t c = 0; c < channels; ++c) sums[c] += weight * point[c];
        });
      }
    }
  });
}

void surface_jets(const Basis& basis, const Control& control, Vec2 u, Vec2 direction, std::span<Jet> out) {
  check_control(basis, control);
  const auto channels = static_cast<std::size_t>(control.channels);
  if (out.size() != channels)
    throw Error(ErrorKind::kInvalidArgument, "there is not as much room as there are channels");
  const PieceSet& set = basis.pieces();
  const TermIndex& index = basis.index();
  std::fill_n(out.begin(), channels, Jet{});
  for (const TermIndex::Entry& e : index.at(u)) {
    if (!index.near(e, u)) continue;
    const Jet w = term_jet(set.terms[e.term], u, direction);
    if (w == Jet{}) continue;
    const auto planes = planes_of(set.pieces[e.piece], control, u);
    for (std::size_t c = 0; c < channels; ++c)
      add(out[c], multiply(w, {planes[c].c, planes[c].x, planes[c].y, 0, 0, 0}));
  }
}

}  // namespace knotreel::spline
