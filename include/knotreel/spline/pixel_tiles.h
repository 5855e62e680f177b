// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/base/error.h"
#include "knotreel/spline/basis.h"

namespace knotreel::spline {

/// The pixels of a picture in tiles of 8x8, and which pieces of a basis reach which tiles: about as many
/// bytes as there are pixels. Immutable and thread safe.
class PixelTiles {
 public:
  static constexpr int kSide = 8;
  static constexpr std::size_t kTilePixels = std::size_t{kSide} * kSide;

  /// What points to other places must outlive this. The pixels cover the domain and need not be square.
  /// @param places of the pixels in the domain, row-major, each on the side of a feature on which it is; or
  ///               none: all at their centres.
  /// @param wanted one per function: pieces of functions that are all 0 here are left out; or none: all.
  /// @param slack pixels by which places may still move: pieces as far away are listed, too.
  /// @throws Error{kInvalidArgument} if sizes do not fit.
  PixelTiles(const Basis& basis, int width, int height, std::span<const Vec2> places,
             std::span<const std::uint8_t> wanted = {}, double slack = 0);

  const Basis& basis() const { return *basis_; }
  int width() const { return width_; }
  int height() const { return height_; }

  /// A tile; those on the right and at the bottom have pixels beside the picture.
  struct Tile {
    int left;
    int top;
    int right;   ///< of its pixels in the picture
    int bottom;  ///< of its pixels in the picture
    int pixels() const { return (right - left) * (bottom - top); }
  };
  std::size_t tile_count() const { return tile_columns_ * tile_rows_; }
  std::size_t tile_columns() const { return tile_columns_; }
  std::size_t tile_rows() const { return tile_rows_; }

  /// Row-major.
  Tile tile(std::size_t index) const;

  /// Calls visit(pixel, place) for the pixels of a tile that are in the picture, row by row: their numbers
  /// in the picture and in the tile.
  template <class Visit>
  void for_pixels(std::size_t index, Visit&& visit) const {
    const Tile t = tile(index);
    for (int y = t.top; y < t.bottom; ++y) {
      std::size_t pixel = std::size_t(y) * std::size_t(width_) + std::size_t(t.left);
      std::size_t place = std::size_t(y - t.top) * kSide;
      for (int x = t.left; x < t.right; ++x) visit(pixel++, place++);
    }
  }

  /// Places of the pixels of a tile, relative to its corner; pixels beside the picture are somewhere near.
  /// @param x, y room for kTilePixels each.
  void places(std::size_t tile, double* x, double* y) const;
  /// The same in single precision: all x, then all y.
  std::span<const float, 2 * kTilePixels> places(std::size_t tile) const {
    return moved_[tile] == kAtCentres ? std::span<const float, 2 * kTilePixels>(centres_)
                                      : std::span<const float, 2 * kTilePixels>(near_[moved_[tile]]);
  }

  /// Whether all pixels of a tile are at their centres.
  bool at_centres(std::size_t tile) const { return moved_[tile] == kAtCentres; }

  /// The upper left corner of a tile, in the domain.
  Vec2 corner(std::size_t tile) const;

  /// Pieces that may be non-zero in a tile, ascending: indices in PieceSet::pieces.
  std::span<const std::uint32_t> pieces(std::size_t tile) const {
    return std::span(pieces_).subspan(piece_begin_[tile], piece_begin_[tile + 1] - piece_begin_[tile]);
  }
  /// Of pieces(tile), among those of all tiles.
  std::size_t first_piece(std::size_t tile) const { return piece_begin_[tile]; }

 private:
  struct alignas(64) NearPlaces : std::array<float, 2 * kTilePixels> {};
  static constexpr std::uint32_t kAtCentres = 0xffffffff;

  bool is_moved(std::size_t tile) const;
  void find_moved();
  void list_pieces(std::span<const std::uint8_t> wanted, double slack);

  const Basis* basis_;
  int width_;
  int height_;
  double cell_width_;
  double cell_height_;
  std::span<const Vec2> places_;
  std::size_t tile_columns_;
  std::size_t tile_rows_;
  std::array<double, kTilePixels> centre_x_;  ///< of the pixels of a tile, from its corner
  std::array<double, kTilePixels> centre_y_;
  NearPlaces centres_;                    ///< the same in single precision
  std::vector<std::uint32_t> moved_;      ///< per tile: index in near_, or kAtCentres
  std::vector<NearPlaces> near_;          ///< of tiles with a pixel that is not at its centre
  std::vector<std::size_t> piece_begin_;  ///< per tile, into pieces_
  std::vector<std::uint32_t> pieces_;
};

}  // namespace knotreel::spline
