// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/normal_equations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <memory>
#include <numeric>
#include <optional>
#include <vector>

#include "base/lanes.h"
#include "base/multiversion.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

using spline::FunctionIndex;
using spline::PixelValues;

constexpr int kTile = PixelValues::kSide;
constexpr std::size_t kTilePixels = PixelValues::kTilePixels;

/// Pixels that are multiplied side by side: a row of a tile, or half of one.
template <class Value>
using RowLanes = LanesOf<Value, 32 / sizeof(Value)>;
template <class Value>
using FourLanes = LanesOf<Value, 4>;

constexpr std::size_t kBlock = 4;          ///< functions that are multiplied with as many others at a time
constexpr std::size_t kChannels = kBlock;  ///< of a picture, at most: they are multiplied like functions

std::size_t padded(std::size_t count) {
  return (count + kBlock - 1) / kBlock * kBlock;
}

/// Tiles by functions.
class TileIndex {
 public:
  /// A function in a tile.
  struct Place {
    std::uint32_t tile;
    std::uint32_t number;  ///< of the function among those of the tile
  };

  TileIndex(const PixelValues& values, const Sought& sought)
      : begin_(values.basis().space().function_count() + 1, 0) {
    for (std::size_t t = 0; t < values.tile_count(); ++t) {
      for (const FunctionIndex f : values.functions(t)) begin_[f + 1] += sought.has(f) ? 1 : 0;
    }
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    places_.resize(begin_.back());
    std::vector<std::size_t> end(begin_.begin(), begin_.end() - 1);
    for (std::size_t t = 0; t < values.tile_count(); ++t) {
      std::uint32_t number = 0;
      for (const FunctionIndex f : values.functions(t)) {
        if (sought.has(f)) places_[end[f]++] = {static_cast<std::uint32_t>(t), number};
        ++number;
      }
    }
  }

  /// Of an unknown function, from top to bottom, from left to right.
  std::span<const Place> places(FunctionIndex f) const {
    return std::span(places_).subspan(begin_[f], begin_[f + 1] - begin_[f]);
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<Place> places_;
};

/// The pixels of a tile, row by row; where they are beside the picture, all functions are zero.
template <class Value>
struct TilePixels {
  bool weighted = false;  ///< whether some pixel has another weight than 1
  std::array<Value, kTilePixels> weights{};
  std::array<Value, kChannels * kTilePixels> samples{};  ///< channel by channel
};

template <class Value>
TilePixels<Value> pixels_of(const image::Image& target, std::span<const float> weights,
                            const PixelValues& values, std::size_t tile) {
  TilePixels<Value> pixels;
  const auto channels = static_cast<std::size_t>(target.channels);
  values.for_pixels(tile, [&](std::size_t from, std::size_t to) {
    pixels.weights[to] = weights.empty() ? 1 : static_cast<Value>(weights[from]);
    pixels.weighted = pixels.weighted || pixels.weights[to] != 1;
    for (std::size_t c = 0; c < channels; ++c)
      pixels.samples[c * kTilePixels + to] = static_cast<Value>(target.samples[from * channels + c]);
  });
  return pixels;
}

/// Writes the sums of four rows of a tile, of which the halves are added up already.
template <class Value>
[[gnu::always_inline]] inline void sum_lanes(const typename FourLanes<Value>::Type (&halves)[kBlock],
                                             Value* out) {
  typename FourLanes<Value>::Type pairs[2];
  for (std::size_t j = 0; j < 2; ++j) {
    pairs[j] = __builtin_shufflevector(halves[2 * j], halves[2 * j + 1], 0, 1, 4, 5) +
               __builtin_shufflevector(halves[2 * j], halves[2 * j + 1], 2, 3, 6, 7);
  }
  FourLanes<Value>::store(__builtin_shufflevector(pairs[0], pairs[1], 0, 2, 4, 6) +
                              __builtin_shufflevector(pairs[0], pairs[1], 1, 3, 5, 7),
                          out);
}

/// Products of kBlock functions with as many others at the same columns of a tile, summed over its rows.
template <class Value>
[[gnu::always_inline]] inline void sum_columns(const Value* a, const Value* b,
                                               typename RowLanes<Value>::Type (&sums)[kBlock][kBlock]) {
  using Lanes = RowLanes<Value>;
  for (std::size_t p = 0; p < kTilePixels; p += kTile) {
    typename Lanes::Type right[kBlock];
    for (std::size_t j = 0; j < kBlock; ++j) Lanes::load(b + j * kTilePixels + p, right[j]);
    for (std::size_t i = 0; i < kBlock; ++i) {
      typename Lanes::Type left;
      Lanes::load(a + i * kTilePixels + p, left);
      for (std::size_t j = 0; j < kBlock; ++j) sums[i][j] += left * right[j];
    }
  }
}

[[gnu::always_inline]] inline void sum_products(const float* a, const float* b, float* out) {
  RowLanes<float>::Type sums[kBlock][kBlock] = {};
  sum_columns(a, b, sums);
  for (std::size_t i = 0; i < kBlock; ++i) {
    FourLanes<float>::Type halves[kBlock];
    for (std::size_t j = 0; j < kBlock; ++j) {
      halves[j] = __builtin_shufflevector(sums[i][j], sums[i][j], 0, 1, 2, 3) +
                  __builtin_shufflevector(sums[i][j], sums[i][j], 4, 5, 6, 7);
    }
    sum_lanes(halves, out + i * kBlock);
  }
}

[[gnu::always_inline]] inline void sum_products(const double* a, const double* b, double* out) {
  RowLanes<double>::Type left[kBlock][kBlock] = {};
  RowLanes<double>::Type right[kBlock][kBlock] = {};
  sum_columns(a, b, left);
  sum_columns(a + kTile / 2, b + kTile / 2, right);
  for (std::size_t i = 0; i < kBlock; ++i) {
    FourLanes<double>::Type halves[kBlock];
    for (std::size_t j = 0; j < kBlock; ++j) halves[j] = left[i][j] + right[i][j];
    sum_lanes(halves, out + i * kBlock);
  }
}

/// All products of kBlock functions with kBlock others, summed over the pixels of a tile: columns first, so
/// that the width of vectors makes no difference.
KNOTREEL_MULTIVERSION
void multiply_block(const double* a, const double* b, double* out) {
  sum_products(a, b, out);
}
KNOTREEL_MULTIVERSION
void multiply_block(const float* a, const float* b, float* out) {
  sum_products(a, b, out);
}

/// Where the products of function i of a tile with all earlier ones and itself begin.
constexpr std::size_t row_begin(std::size_t i) {
  return i * (i + 1) / 2;
}

/// Sums over the pixels of a tile of the products of its functions: for each function those with all earlier
/// ones and itself, one row after the other, without gaps, as rows of the matrix are summed up.
/// @param weighted the values again, times the weights of the pixels.
template <class Value>
void multiply(const Value* values, const Value* weighted, std::size_t count, Value* products) {
  std::array<Value, kBlock * kBlock> block;
  for (std::size_t i = 0; i < count; i += kBlock) {
    for (std::size_t j = i; j < count; j += kBlock) {
      multiply_block(values + i * kTilePixels, weighted + j * kTilePixels, block.data());
      for (std::size_t l = 0; l < std::min(kBlock, count - j); ++l) {
        Value* row = products + row_begin(j + l) + i;
        for (std::size_t k = 0; k < (j == i ? l + 1 : kBlock); ++k) row[k] = block[k * kBlock + l];
      }
    }
  }
}

/// What the pixels of each tile add to the normal equations.
template <class Value>
class TileSums {
 public:
  TileSums(const PixelValues& values, const image::Image& target, std::span<const float> weights,
           const Sought& sought)
      : product_begin_(values.tile_count() + 1, 0), right_begin_(values.tile_count() + 1, 0) {
    for (std::size_t t = 0; t < values.tile_count(); ++t) {
      const std::size_t n = values.functions(t).size();
      product_begin_[t + 1] = product_begin_[t] + n * (n + 1) / 2;
      right_begin_[t + 1] = right_begin_[t] + kChannels * padded(n);
    }
    products_ = std::make_unique_for_overwrite<Value[]>(product_begin_.back());
    right_ = std::make_unique_for_overwrite<Value[]>(right_begin_.back());
    constexpr std::size_t kTiles = 16;
    parallel_for((values.tile_count() + kTiles - 1) / kTiles, [&](std::size_t block) {
      thread_local Scratch scratch;
      for (std::size_t t = block * kTiles; t < std::min(values.tile_count(), (block + 1) * kTiles); ++t) {
        const auto functions = values.functions(t);
        const auto known = std::count_if(functions.begin(), functions.end(),
                                         [&](FunctionIndex f) { return !sought.has(f); });
        if (static_cast<std::size_t>(known) == functions.size()) continue;
        add(values, t, target, weights, known > 0 ? &sought : nullptr, scratch);
      }
    });
  }

  /// Products of a function of a tile with all earlier ones and itself.
  const Value* products(TileIndex::Place place) const {
    return products_.get() + product_begin_[place.tile] + row_begin(place.number);
  }
  /// Four channels.
  const Value* right(TileIndex::Place place) const {
    return right_.get() + right_begin_[place.tile] + kChannels * std::size_t{place.number};
  }

 private:
  struct Scratch {
    std::vector<Value> values;    ///< function by function, up to a whole number of blocks
    std::vector<Value> weighted;  ///< the same times the weights of the pixels
  };

  void add(const PixelValues& all, std::size_t t, const image::Image& target, std::span<const float> weights,
           const Sought* sought, Scratch& scratch) {
    const std::size_t count = all.functions(t).size();
    scratch.values.resize(padded(count) * kTilePixels);
    all.evaluate(t, scratch.values.data());
    std::fill(scratch.values.begin() + static_cast<std::ptrdiff_t>(count * kTilePixels), scratch.values.end(),
              Value{0});
    TilePixels<Value> pixels = pixels_of<Value>(target, weights, all, t);
    if (sought) take_off_known(*sought, all.functions(t), target.channels, scratch.values, pixels);
    const Value* right = scratch.values.data();
    if (pixels.weighted) {
      scratch.weighted.resize(scratch.values.size());
      for (std::size_t f = 0; f < scratch.values.size(); f += kTilePixels) {
        for (std::size_t i = 0; i < kTilePixels; ++i)
          scratch.weighted[f + i] = scratch.values[f + i] * pixels.weights[i];
      }
      right = scratch.weighted.data();
    }
    multiply(scratch.values.data(), right, count, products_.get() + product_begin_[t]);
    for (std::size_t i = 0; i < count; i += kBlock) {
      multiply_block(right + i * kTilePixels, pixels.samples.data(),
                     right_.get() + right_begin_[t] + i * kChannels);
    }
  }

  static void take_off_known(const Sought& sought, std::span<const FunctionIndex> functions, int channels,
                             const std::vector<Value>& values, TilePixels<Value>& pixels) {
    const auto count = static_cast<std::size_t>(channels);
    for (std::size_t i = 0; i < functions.size(); ++i) {
      if (sought.has(functions[i])) continue;
      for (std::size_t c = 0; c < count; ++c) {
        const auto point = static_cast<Value>(sought.known[functions[i] * count + c]);
        for (std::size_t p = 0; p < kTilePixels; ++p)
          pixels.samples[c * kTilePixels + p] -= point * values[i * kTilePixels + p];
      }
    }
  }

  std::vector<std::size_t> product_begin_;
  std::vector<std::size_t> right_begin_;
  std::unique_ptr<Value[]> products_;  ///< not vectors, which would be zeroed first
  std::unique_ptr<Value[]> right_;
};

struct Entry {
  std::uint32_t column;  ///< number of an unknown
  double value;
};

constexpr std::size_t kEntriesPerRow = 16;  // more than there are nearly always

/// Rows of the matrix, one after the other.
struct BlockRows {
  std::vector<Entry> entries;
  std::vector<std::size_t> ends;
};

/// Sums up rows of the matrix; one per thread.
class RowSum {
 public:
  explicit RowSum(std::size_t functions) : slots_(functions, {spline::kNoFunction, 0}), row_(functions) {}

  /// Appends the lower half of the row of an unknown function: the diagonal, and what is not 0 before it, in
  /// any order.
  template <class Value>
  void add(FunctionIndex f, const PixelValues& values, const TileIndex& index, const TileSums<Value>& sums,
           const Sought& sought, BlockRows& rows) {
    Slot* const slots = slots_.data();
    Entry* const row = row_.data();
    std::uint32_t count = 1;
    row[0] = {sought.number_of[f], 0.0};
    slots[f] = {f, 0};
    for (const TileIndex::Place place : index.places(f)) {
      const auto functions = values.functions(place.tile);
      const Value* product = sums.products(place);
      for (const FunctionIndex g : functions.first(place.number + 1)) {
        if (slots[g].row != f) {
          slots[g] = {f, count};
          row[count++] = {sought.number_of[g], 0.0};
        }
        row[slots[g].at].value += static_cast<double>(*product++);
      }
    }
    std::copy_if(row, row + count, std::back_inserter(rows.entries),
                 [self = sought.number_of[f]](const Entry& e) {
                   return e.column == self || (e.value != 0 && e.column != Sought::kKnown);
                 });
    rows.ends.push_back(rows.entries.size());
  }

 private:
  /// Where a column is in the row.
  struct Slot {
    FunctionIndex row;  ///< for which this holds
    std::uint32_t at;
  };
  std::vector<Slot> slots_;
  std::vector<Entry> row_;  ///< with room for all functions
};

/// By columns, with ascending rows. @param blocks of rows, in order.
Eigen::SparseMatrix<double> to_matrix(const std::vector<BlockRows>& blocks, std::size_t unknowns) {
  const auto n = static_cast<Eigen::Index>(unknowns);
  std::vector<int> end(unknowns + 1, 0);
  for (const BlockRows& block : blocks) {
    for (const Entry& e : block.entries) ++end[e.column + 1];
  }
  std::partial_sum(end.begin(), end.end(), end.begin());
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.resizeNonZeros(end.back());
  std::copy(end.begin(), end.end(), matrix.outerIndexPtr());
  int row = 0;
  for (const BlockRows& block : blocks) {
    std::size_t i = 0;
    for (const std::size_t row_end : block.ends) {
      for (; i < row_end; ++i) {
        const int at = end[block.entries[i].column]++;
        matrix.innerIndexPtr()[at] = row;
        matrix.valuePtr()[at] = block.entries[i].value;
      }
      ++row;
    }
  }
  return matrix;
}

template <class Value>
NormalEquations assemble_in(const PixelValues& values, const image::Image& target,
                            std::span<const float> weights, const Sought& sought) {
  const auto& mesh = values.basis().space().mesh();
  if (target.width != values.width() || target.height != values.height() ||
      std::fmod(mesh.width, target.width) != 0 || std::fmod(mesh.height, target.height) != 0)
    throw Error(ErrorKind::kInvalidArgument, "a fit needs a knot mesh of the size of the picture");
  const std::size_t functions = values.basis().space().function_count();
  const std::size_t count = sought.functions.size();
  NormalEquations normal;
  normal.right.setZero(static_cast<Eigen::Index>(count), target.channels);
  std::optional<TileIndex> index;
  std::optional<TileSums<Value>> sums;
  parallel_invoke([&] { index.emplace(values, sought); },
                  [&] { sums.emplace(values, target, weights, sought); });
  const std::size_t block_size =
      std::max<std::size_t>(64, functions / 64);  // each clears a list of all functions
  std::vector<BlockRows> rows((count + block_size - 1) / block_size);
  parallel_for(rows.size(), [&](std::size_t block) {
    RowSum row(functions);
    rows[block].entries.reserve(kEntriesPerRow * block_size);
    rows[block].ends.reserve(block_size);
    for (std::size_t i = block * block_size; i < std::min(count, (block + 1) * block_size); ++i) {
      const FunctionIndex f = sought.functions[i];
      row.add(f, values, *index, *sums, sought, rows[block]);
      std::array<double, kChannels> right{};
      for (const TileIndex::Place place : index->places(f)) {
        for (std::size_t c = 0; c < kChannels; ++c) right[c] += static_cast<double>(sums->right(place)[c]);
      }
      for (Eigen::Index c = 0; c < target.channels; ++c)
        normal.right(static_cast<Eigen::Index>(i), c) = right[static_cast<std::size_t>(c)];
    }
  });
  normal.matrix = to_matrix(rows, count);
  return normal;
}

}  // namespace

Sought::Sought(std::size_t function_count, std::span<const std::uint8_t> fixed,
               std::span<const double> control)
    : number_of(function_count, kKnown), known(control) {
  functions.reserve(function_count);
  for (FunctionIndex f = 0; f < function_count; ++f) {
    if (!fixed.empty() && fixed[f]) continue;
    number_of[f] = static_cast<std::uint32_t>(functions.size());
    functions.push_back(f);
  }
}

template <class Value>
NormalEquations assemble(const PixelValues& values, const image::Image& target,
                         std::span<const float> weights, const Sought& sought) {
  return assemble_in<Value>(values, target, weights, sought);
}

template NormalEquations assemble<double>(const PixelValues&, const image::Image&, std::span<const float>,
                                          const Sought&);
template NormalEquations assemble<float>(const PixelValues&, const image::Image&, std::span<const float>,
                                         const Sought&);

}  // namespace knotreel::fit
