#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "knotreel/spline/basis.h"

namespace knotreel::spline {

/// All basis functions at all pixels of a picture, the matrix A of the least-squares problems, in tiles of
/// 8x8 pixels. Values are made when they are asked for: that is quicker than to fetch them from memory again.
/// Holds which pieces reach which tiles, about as many bytes as there are pixels. Immutable and thread safe.
class PixelValues {
 public:
  static constexpr int kSide = 8;
  static constexpr std::size_t kTilePixels = std::size_t{kSide} * kSide;

  /// What points to other places must outlive this. The pixels cover the domain and need not be square.
  /// @param places of the pixels in the domain, row-major, each on the side of a feature on which it is; or
  ///               none: all at their centres.
  /// @param wanted one per function: 0 counts as zero everywhere, and costs nothing; or none: all. Not kept.
  /// @throws Error{kInvalidArgument} if sizes do not fit.
  PixelValues(const Basis& basis, int width, int height, std::span<const Vec2> places,
              std::span<const std::uint8_t> wanted = {});

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

  /// Functions that may be non-zero somewhere in a tile, ascending.
  std::span<const FunctionIndex> functions(std::size_t tile) const {
    return std::span(functions_)
        .subspan(function_begin_[tile], function_begin_[tile + 1] - function_begin_[tile]);
  }

  /// Values of the functions of a tile at its pixels: function by function, kTilePixels each, row by row; at
  /// pixels beside the picture zero. They agree with Basis::evaluate() to 1e-10.
  /// @param values room for as many.
  void evaluate(std::size_t tile, double* values) const;
  /// The same in single precision.
  void evaluate(std::size_t tile, float* values) const;

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

  static constexpr std::uint32_t kNoSlot = 0xffffffff;

  /// A piece that may be non-zero in a tile.
  struct Entry {
    std::uint32_t piece;                 ///< index in PieceSet::pieces
    std::array<std::uint32_t, 3> slots;  ///< of its functions among those of the tile; kNoSlot: not wanted
  };

  /// By piece, ascending.
  std::span<const Entry> entries(std::size_t tile) const {
    return std::span(entries_).subspan(entry_begin_[tile], entry_begin_[tile + 1] - entry_begin_[tile]);
  }

 private:
  struct alignas(64) NearPlaces : std::array<float, 2 * kTilePixels> {};
  static constexpr std::uint32_t kAtCentres = 0xffffffff;

  bool is_moved(std::size_t tile) const;
  void find_moved();
  void list_entries(std::span<const std::uint8_t> wanted);
  void name_functions(std::span<const std::uint8_t> wanted);
  template <class Value>
  void evaluate_in(std::size_t tile, Value* values) const;

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
  std::vector<std::size_t> entry_begin_;  ///< per tile, into entries_
  std::vector<Entry> entries_;
  std::vector<std::size_t> function_begin_;  ///< per tile, into functions_
  std::vector<FunctionIndex> functions_;
};

/// A surface at the pixels of a tile: channel by channel, kTilePixels each, row by row.
template <class Value>
using TileSurface = std::array<Value, 4 * PixelValues::kTilePixels>;

/// For each pixel of a tile, sum over functions of value times control point.
/// @param control function by function, `channels` numbers each, 1 to 4. @param memory for working.
/// @tparam Value double or float.
template <class Value>
void surface_of_tile(const PixelValues& values, std::size_t tile, std::span<const double> control,
                     int channels, std::vector<Value>& memory, TileSurface<Value>& out);

/// The same for all tiles: calls visit(index of the tile, surface), in any order, on all threads allowed.
template <class Value>
void for_surface_tiles(const PixelValues& values, std::span<const double> control, int channels,
                       const std::function<void(std::size_t, const TileSurface<Value>&)>& visit);

/// The same for the whole picture. @param out row-major, channels interleaved.
template <class Value>
void surface_at_pixels(const PixelValues& values, std::span<const double> control, int channels,
                       std::span<Value> out);

}  // namespace knotreel::spline
