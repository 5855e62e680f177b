// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/spline/pixel_values.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "knotreel/base/parallel.h"
#include "spline/tile_terms.h"

namespace knotreel::spline {

namespace {

constexpr std::size_t kFunctionsPerTile = 16;  // that room is made for

}  // namespace

PixelValues::PixelValues(const Basis& basis, int width, int height, std::span<const Vec2> places,
                         std::span<const std::uint8_t> wanted)
    : PixelTiles(basis, width, height, places, wanted) {
  name_functions(wanted);
}

void PixelValues::name_functions(std::span<const std::uint8_t> wanted) {
  const std::size_t function_count = basis().space().function_count();
  std::vector<std::vector<FunctionIndex>> by_row(tile_rows());
  function_begin_.assign(tile_count() + 1, 0);
  slots_.resize(first_piece(tile_count()));
  parallel_for(tile_rows(), [&](std::size_t row) {
    std::vector<FunctionIndex>& all = by_row[row];
    all.reserve(kFunctionsPerTile * tile_columns());
    // Each tile clears what it has used, so that those of one row are clear for the next of this thread. If
    // something is thrown in between, they are gone.
    thread_local std::vector<std::uint32_t> clear_slots;
    std::vector<std::uint32_t> slot = std::move(clear_slots);
    if (slot.size() < function_count) slot.resize(function_count, kNoSlot);
    for (std::size_t t = row * tile_columns(); t < (row + 1) * tile_columns(); ++t) {
      const auto reaching = pieces(t);
      const std::size_t first = all.size();
      for (const std::uint32_t p : reaching) {
        for (const FunctionIndex f : basis().pieces().pieces[p].functions) {
          if (f == kNoFunction || slot[f] != kNoSlot || (!wanted.empty() && !wanted[f])) continue;
          slot[f] = 0;
          all.push_back(f);
        }
      }
      std::sort(all.begin() + static_cast<std::ptrdiff_t>(first), all.end());
      for (std::size_t i = first; i < all.size(); ++i) slot[all[i]] = static_cast<std::uint32_t>(i - first);
      for (std::size_t i = 0; i < reaching.size(); ++i) {
        const auto& functions = basis().pieces().pieces[reaching[i]].functions;
        for (std::size_t k = 0; k < 3; ++k)
          slots_[first_piece(t) + i][k] = functions[k] == kNoFunction ? kNoSlot : slot[functions[k]];
      }
      for (std::size_t i = first; i < all.size(); ++i) slot[all[i]] = kNoSlot;
      function_begin_[t + 1] = all.size() - first;
    }
    clear_slots = std::move(slot);
  });
  std::partial_sum(function_begin_.begin(), function_begin_.end(), function_begin_.begin());
  functions_.reserve(function_begin_.back());
  for (const auto& row : by_row) functions_.insert(functions_.end(), row.begin(), row.end());
}

template <class Value>
void PixelValues::evaluate_in(std::size_t index, Value* values) const {
  const PieceSet& set = basis().pieces();
  const std::size_t count = functions(index).size();
  // A point counts as inside the closed face, so a negative coordinate is the tolerance of a wall.
  const bool clamp = basis().space().degree() == 1;
  std::fill_n(values, count * kTilePixels, Value{0});
  TilePlaces<Value> places(*this, index);
  const auto slots = this->slots(index);
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const Piece& piece = set.pieces[pieces(index)[i]];
    std::array<Share<Value>, 3> shares;
    std::size_t n = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      if (slots[i][k] == kNoSlot) continue;
      shares[n++] = {plane_in<Value>(plane_of(piece.weights[k], places.origin())),
                     values + std::size_t{slots[i][k]} * kTilePixels};
    }
    places.add(set, piece, std::span(shares).first(n), clamp);
  }
  const Tile tile = this->tile(index);
  if (tile.pixels() == kSide * kSide) return;
  for (std::size_t f = 0; f < count; ++f) {
    for (int j = 0; j < kSide; ++j) {
      for (int i = 0; i < kSide; ++i) {
        if (tile.left + i >= width() || tile.top + j >= height())
          values[f * kTilePixels + static_cast<std::size_t>(j * kSide + i)] = 0;
      }
    }
  }
}

void PixelValues::evaluate(std::size_t index, double* values) const {
  evaluate_in(index, values);
}
void PixelValues::evaluate(std::size_t index, float* values) const {
  evaluate_in(index, values);
}

}  // namespace knotreel::spline
