// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "knotreel/base/error.h"
#include "knotreel/spline/pixel_tiles.h"

/// Surfaces: sums over functions of value times control point. The three functions of a piece are added up
/// first, which leaves one plane per channel, so that no function is ever evaluated.
namespace knotreel::spline {

inline constexpr int kMaxSurfaceChannels = 4;

/// Control points of a surface.
struct Control {
  std::span<const double> points;  ///< function by function, `channels` numbers each
  int channels;                    ///< 1 to kMaxSurfaceChannels
};

/// A surface at the pixels of a tile: channel by channel, kTilePixels each, row by row. Beside the picture it
/// holds anything.
template <class Value>
using TileSurface = std::array<Value, kMaxSurfaceChannels * PixelTiles::kTilePixels>;

/// @param control of functions that the tiles were not made for must be 0.
/// @tparam Value double or float.
template <class Value>
void surface_of_tile(const PixelTiles& tiles, std::size_t tile, const Control& control,
                     TileSurface<Value>& out);

/// The same with the pixels of the tile at other places, not further away than the tiles have slack.
/// @param places row by row; those beside the picture anywhere near.
template <class Value>
void surface_of_tile(const PixelTiles& tiles, std::size_t tile,
                     std::span<const Vec2, PixelTiles::kTilePixels> places, const Control& control,
                     TileSurface<Value>& out);

/// The same for all tiles: calls visit(index of the tile, surface), in any order, on all threads allowed.
/// @param skipped by tile: 1 for those that are left out; or none.
template <class Value>
void for_surface_tiles(const PixelTiles& tiles, const Control& control,
                       const std::function<void(std::size_t, const TileSurface<Value>&)>& visit,
                       std::span<const std::uint8_t> skipped = {});

/// The same for the whole picture. @param out row-major, channels interleaved; stays as it is where tiles are
/// skipped.
template <class Value>
void surface_at_pixels(const PixelTiles& tiles, const Control& control, std::span<Value> out,
                       std::span<const std::uint8_t> skipped = {});

/// The surface at any points of the closed domain (beside it, it is 0), on all threads allowed; where a side
/// must be chosen, as Basis::evaluate() does. With FrameModel::colour these are colours at parameters, which
/// lie elsewhere in the picture where the model has displacements; raster::Renderer draws the picture.
/// @param out point by point, channels interleaved.
/// @throws Error{kInvalidArgument} for control points that are not one per function, or if `out` has not as
/// many numbers as there are points times channels.
void surface_at_points(const Basis& basis, const Control& control, std::span<const Vec2> points,
                       std::span<double> out);

/// The surface with its derivatives at a point, limits from the side of `direction`.
/// @param out one per channel. @throws Error{kInvalidArgument} likewise.
void surface_jets(const Basis& basis, const Control& control, Vec2 u, Vec2 direction, std::span<Jet> out);

}  // namespace knotreel::spline
