// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "knotreel/spline/pixel_tiles.h"
#include "spline/plane.h"

/// Terms of pieces at all pixels of a tile at once.
namespace knotreel::spline {

inline constexpr std::size_t kPixels = PixelTiles::kTilePixels;

/// A plane by which terms are multiplied, and where the products are added: one per pixel of a tile.
template <class Value>
struct Share {
  PlaneIn<Value> plane;
  Value* sums;
};

/// The pixels of a tile, relative to its corner. Not thread safe.
template <class Value>
class TilePlaces {
 public:
  TilePlaces(const PixelTiles& tiles, std::size_t tile);
  /// With the pixels at other places, not further away than the tiles have slack.
  TilePlaces(const PixelTiles& tiles, std::size_t tile, std::span<const Vec2, kPixels> places);
  TilePlaces(const TilePlaces&) = delete;
  TilePlaces& operator=(const TilePlaces&) = delete;

  Vec2 origin() const { return origin_; }

  /// Adds the terms of a piece times the planes of the shares.
  /// @param clamp planes count as zero where they are negative.
  void add(const PieceSet& set, const Piece& piece, std::span<const Share<Value>> shares, bool clamp);

 private:
  void add_one_by_one(const PieceTerm& term, std::span<const Share<Value>> shares, bool clamp);
  /// In double precision, which float needs only where there are walls.
  const double* exact();

  const PixelTiles& tiles_;
  std::size_t tile_;
  Vec2 origin_;
  alignas(64) std::array<Value, 2 * kPixels> other_;  ///< if they are at other places
  const Value* x_;
  std::array<double, 2 * kPixels> exact_;  ///< all x, then all y
  bool has_exact_ = false;
};

}  // namespace knotreel::spline
