// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/spline/pixel_tiles.h"

namespace knotreel::spline {

/// All basis functions at all pixels of a picture, the matrix A of the least-squares problems, in tiles.
/// Values are made when they are asked for: that is quicker than to fetch them from memory again. Immutable
/// and thread safe.
class PixelValues : public PixelTiles {
 public:
  /// As PixelTiles. @param wanted functions that are 0 here count as zero everywhere, and cost nothing.
  PixelValues(const Basis& basis, int width, int height, std::span<const Vec2> places,
              std::span<const std::uint8_t> wanted = {});

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

  /// Where the functions of a piece are among those of a tile.
  using Slots = std::array<std::uint32_t, 3>;
  static constexpr std::uint32_t kNoSlot = 0xffffffff;  ///< of functions that are not wanted

  /// Of the pieces of a tile, in the order of pieces().
  std::span<const Slots> slots(std::size_t tile) const {
    return std::span(slots_).subspan(first_piece(tile), pieces(tile).size());
  }

 private:
  void name_functions(std::span<const std::uint8_t> wanted);
  template <class Value>
  void evaluate_in(std::size_t tile, Value* values) const;

  std::vector<Slots> slots_;                 ///< of all pieces of all tiles
  std::vector<std::size_t> function_begin_;  ///< per tile, into functions_
  std::vector<FunctionIndex> functions_;
};

}  // namespace knotreel::spline
