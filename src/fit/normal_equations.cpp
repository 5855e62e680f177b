#include "fit/normal_equations.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

using spline::FunctionIndex;
using spline::GridValues;

constexpr int kTile = 8;  // pixels
constexpr std::size_t kTilePixels = std::size_t{kTile} * kTile;

/// A row of pixels of a tile.
using Row [[gnu::vector_size(kTile * sizeof(double))]] = double;

constexpr std::size_t kBlock = 4;          ///< functions that are multiplied with as many others at a time
constexpr std::size_t kChannels = kBlock;  ///< of a picture, at most: they are multiplied like functions
static_assert(GridValues::kMargin >= std::size_t{kTile}, "gather() reads whole rows of tiles");

std::size_t padded(std::size_t count) {
  return (count + kBlock - 1) / kBlock * kBlock;
}

/// Functions by tiles of 8x8 pixels that their rows touch, and tiles by functions.
class TileIndex {
 public:
  /// A function in a tile.
  struct Place {
    std::uint32_t tile;
    std::uint32_t number;  ///< of the function among those of the tile
  };

  /// @param active as in assemble(). @param begin, end of the rows of pixels.
  TileIndex(const GridValues& grid, std::span<const std::uint8_t> active, int width, int begin, int end)
      : columns_(static_cast<std::size_t>((width + kTile - 1) / kTile)), top_(begin / kTile) {
    const auto rows = static_cast<std::size_t>((end + kTile - 1) / kTile - top_);
    const std::size_t functions = grid.row_begin.size() - 1;
    place_begin_.assign(functions + 1, 0);
    for (FunctionIndex f = 0; f < functions; ++f) {
      if (active.empty() || active[f])
        for_tiles(grid.rows_of(f), [&](std::size_t tile) { places_.push_back({std::uint32_t(tile), 0}); });
      place_begin_[f + 1] = places_.size();
    }
    begin_.assign(columns_ * rows + 1, 0);
    for (const Place& place : places_) ++begin_[place.tile + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    functions_.resize(places_.size());
    std::vector<std::size_t> cursor(begin_.begin(), begin_.end() - 1);
    for (FunctionIndex f = 0; f < functions; ++f) {
      for (std::size_t i = place_begin_[f]; i < place_begin_[f + 1]; ++i) {
        std::size_t& at = cursor[places_[i].tile];
        places_[i].number = static_cast<std::uint32_t>(at - begin_[places_[i].tile]);
        functions_[at++] = f;
      }
    }
  }

  std::size_t tiles() const { return begin_.size() - 1; }
  int left(std::size_t tile) const { return static_cast<int>(tile % columns_) * kTile; }
  int top(std::size_t tile) const { return (top_ + static_cast<int>(tile / columns_)) * kTile; }

  /// Ascending.
  std::span<const FunctionIndex> functions(std::size_t tile) const {
    return std::span(functions_).subspan(begin_[tile], begin_[tile + 1] - begin_[tile]);
  }
  /// From top to bottom, from left to right.
  std::span<const Place> places(FunctionIndex f) const {
    return std::span(places_).subspan(place_begin_[f], place_begin_[f + 1] - place_begin_[f]);
  }

 private:
  template <class Visit>
  void for_tiles(std::span<const GridValues::Row> rows, Visit&& visit) const {
    for (std::size_t i = 0; i < rows.size();) {
      const int tile_row = rows[i].y / kTile;
      int low = std::numeric_limits<int>::max();
      int high = 0;
      for (; i < rows.size() && rows[i].y / kTile == tile_row; ++i) {
        if (rows[i].x_begin >= rows[i].x_end) continue;
        low = std::min(low, rows[i].x_begin);
        high = std::max(high, rows[i].x_end);
      }
      for (int c = low / kTile; c * kTile < high; ++c)
        visit(static_cast<std::size_t>(tile_row - top_) * columns_ + static_cast<std::size_t>(c));
    }
  }

  std::size_t columns_;
  int top_;  ///< tile row of the first tile
  std::vector<std::size_t> begin_;
  std::vector<FunctionIndex> functions_;
  std::vector<std::size_t> place_begin_;
  std::vector<Place> places_;
};

/// The pixels of a tile, row by row; those beside the picture have no weight.
struct TilePixels {
  bool weighted = false;  ///< whether some pixel has another weight than 1
  std::array<double, kTilePixels> weights{};
  std::array<double, kChannels * kTilePixels> samples{};  ///< channel by channel
};

TilePixels pixels_of(const image::Image& target, std::span<const float> weights, int left, int top) {
  TilePixels tile;
  const auto channels = static_cast<std::size_t>(target.channels);
  for (int y = top; y < std::min(top + kTile, target.height); ++y) {
    for (int x = left; x < std::min(left + kTile, target.width); ++x) {
      const auto from = static_cast<std::size_t>(y) * std::size_t(target.width) + static_cast<std::size_t>(x);
      const auto to = static_cast<std::size_t>((y - top) * kTile + (x - left));
      tile.weights[to] = weights.empty() ? 1 : static_cast<double>(weights[from]);
      tile.weighted = tile.weighted || tile.weights[to] != 1;
      for (std::size_t c = 0; c < channels; ++c)
        tile.samples[c * kTilePixels + to] = static_cast<double>(target.samples[from * channels + c]);
    }
  }
  return tile;
}

using RowMask [[gnu::vector_size(sizeof(Row))]] = std::int64_t;
constexpr std::int64_t kFromMiddle[2 * kTile] = {0, 0, 0, 0, 0, 0, 0, 0, -1, -1, -1, -1, -1, -1, -1, -1};
constexpr std::int64_t kToMiddle[2 * kTile] = {-1, -1, -1, -1, -1, -1, -1, -1, 0, 0, 0, 0, 0, 0, 0, 0};

/// Copies the values of functions within a tile, function by function; padding is zero.
KNOTREEL_MULTIVERSION
void gather(const GridValues& grid, std::span<const FunctionIndex> functions, int left, int top,
            double* out) {
  for (std::size_t i = 0; i < padded(functions.size()); ++i) {
    RowMask rows[kTile] = {};
    if (i < functions.size()) {
      const auto all = grid.rows_of(functions[i]);
      const int from = std::max(top, all.front().y);
      const int to = std::min(top + kTile, all.back().y + 1);
      const GridValues::Row* row = all.data() + (from - all.front().y);
      for (int y = from; y < to; ++y, ++row) {
        // Values of the neighbouring rows are read, and left out: quicker than a loop over a few pixels.
        if (row->x_begin >= left + kTile || row->x_end <= left) continue;
        RowMask values;
        RowMask from_begin;
        RowMask to_end;
        std::memcpy(&values, grid.values.data() + row->offset + (left - row->x_begin), sizeof values);
        std::memcpy(&from_begin, kFromMiddle + kTile - std::clamp(row->x_begin - left, 0, kTile),
                    sizeof values);
        std::memcpy(&to_end, kToMiddle + kTile - std::clamp(row->x_end - left, 0, kTile), sizeof values);
        rows[y - top] = values & from_begin & to_end;
      }
    }
    std::memcpy(out + i * kTilePixels, rows, sizeof rows);
  }
}

/// All products of kBlock functions with kBlock others, summed over the pixels of a tile: columns first, so
/// that the width of vectors makes no difference.
KNOTREEL_MULTIVERSION
void multiply_block(const double* a, const double* b, double* out) {
  Row sums[kBlock][kBlock] = {};
  for (std::size_t p = 0; p < kTilePixels; p += kTile) {
    Row right[kBlock];
    for (std::size_t j = 0; j < kBlock; ++j) std::memcpy(&right[j], b + j * kTilePixels + p, sizeof(Row));
    for (std::size_t i = 0; i < kBlock; ++i) {
      Row left;
      std::memcpy(&left, a + i * kTilePixels + p, sizeof left);
      for (std::size_t j = 0; j < kBlock; ++j) sums[i][j] += left * right[j];
    }
  }
  for (std::size_t i = 0; i < kBlock; ++i) {
    for (std::size_t j = 0; j < kBlock; ++j) {
      const Row& s = sums[i][j];
      out[i * kBlock + j] = ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
    }
  }
}

/// Where the products of function i of a tile with itself and all later ones begin.
constexpr std::size_t row_begin(std::size_t i, std::size_t count) {
  return i * (2 * count - i + 1) / 2;
}

/// Sums over the pixels of a tile of the products of its functions: for each function those with itself and
/// all later ones, one row after the other, without gaps.
/// @param weighted the values again, times the weights of the pixels.
void multiply(const double* values, const double* weighted, std::size_t count, double* products) {
  std::array<double, kBlock * kBlock> block;
  for (std::size_t i = 0; i < count; i += kBlock) {
    for (std::size_t j = i; j < count; j += kBlock) {
      multiply_block(values + i * kTilePixels, weighted + j * kTilePixels, block.data());
      for (std::size_t k = 0; k < std::min(kBlock, count - i); ++k) {
        double* row = products + row_begin(i + k, count);
        const std::size_t first = j == i ? k : 0;
        for (std::size_t l = first; l < std::min(kBlock, count - j); ++l)
          row[j + l - (i + k)] = block[k * kBlock + l];
      }
    }
  }
}

/// What the pixels of each tile add to the normal equations.
class TileSums {
 public:
  TileSums(const GridValues& grid, const TileIndex& index, const image::Image& target,
           std::span<const float> weights)
      : product_begin_(index.tiles() + 1, 0), right_begin_(index.tiles() + 1, 0) {
    for (std::size_t t = 0; t < index.tiles(); ++t) {
      const std::size_t n = index.functions(t).size();
      product_begin_[t + 1] = product_begin_[t] + n * (n + 1) / 2;
      right_begin_[t + 1] = right_begin_[t] + kChannels * padded(n);
    }
    products_ = std::make_unique_for_overwrite<double[]>(product_begin_.back());
    right_ = std::make_unique_for_overwrite<double[]>(right_begin_.back());
    constexpr std::size_t kTiles = 16;
    parallel_for((index.tiles() + kTiles - 1) / kTiles, [&](std::size_t block) {
      std::vector<double> values;
      std::vector<double> weighted;
      for (std::size_t t = block * kTiles; t < std::min(index.tiles(), (block + 1) * kTiles); ++t) {
        const auto functions = index.functions(t);
        if (functions.empty()) continue;
        const TilePixels pixels = pixels_of(target, weights, index.left(t), index.top(t));
        values.resize(padded(functions.size()) * kTilePixels);
        gather(grid, functions, index.left(t), index.top(t), values.data());
        if (pixels.weighted) {
          weighted.resize(values.size());
          for (std::size_t i = 0; i < values.size(); ++i)
            weighted[i] = values[i] * pixels.weights[i % kTilePixels];
        }
        const double* right = pixels.weighted ? weighted.data() : values.data();
        multiply(values.data(), right, functions.size(), products_.get() + product_begin_[t]);
        for (std::size_t i = 0; i < functions.size(); i += kBlock) {
          multiply_block(right + i * kTilePixels, pixels.samples.data(),
                         right_.get() + right_begin_[t] + i * kChannels);
        }
      }
    });
  }

  /// Products of the functions of a tile from a number on with the function of that number.
  /// @param count of functions of the tile.
  const double* products(TileIndex::Place place, std::size_t count) const {
    return products_.get() + product_begin_[place.tile] + row_begin(place.number, count);
  }
  /// Four channels.
  const double* right(TileIndex::Place place) const {
    return right_.get() + right_begin_[place.tile] + kChannels * std::size_t{place.number};
  }

 private:
  std::vector<std::size_t> product_begin_;
  std::vector<std::size_t> right_begin_;
  std::unique_ptr<double[]> products_;  ///< not vectors, which would be zeroed first
  std::unique_ptr<double[]> right_;
};

struct Entry {
  FunctionIndex row;
  double value;
};

/// Columns of the matrix, one after the other.
struct Columns {
  std::vector<Entry> entries;
  std::vector<std::size_t> ends;
};

/// Sums up columns of the matrix; one per thread.
class ColumnSum {
 public:
  explicit ColumnSum(std::size_t functions) : slot_(functions), seen_(functions, spline::kNoFunction) {}

  /// Appends the lower half of column f, ascending, zeros left out but for the diagonal.
  void add(FunctionIndex f, const TileIndex& index, const TileSums& sums, Columns& columns) {
    column_.clear();
    column_.push_back({f, 0.0});
    seen_[f] = f;
    slot_[f] = 0;
    for (const TileIndex::Place place : index.places(f)) {
      const auto functions = index.functions(place.tile);
      const double* products = sums.products(place, functions.size());
      for (const FunctionIndex g : functions.subspan(place.number)) {
        if (seen_[g] != f) {
          seen_[g] = f;
          slot_[g] = static_cast<std::uint32_t>(column_.size());
          column_.push_back({g, 0.0});
        }
        column_[slot_[g]].value += *products++;
      }
    }
    std::erase_if(column_, [f](const Entry& e) { return e.value == 0 && e.row != f; });
    std::sort(column_.begin(), column_.end(), [](const Entry& a, const Entry& b) { return a.row < b.row; });
    columns.entries.insert(columns.entries.end(), column_.begin(), column_.end());
    columns.ends.push_back(columns.entries.size());
  }

 private:
  std::vector<std::uint32_t> slot_;
  std::vector<FunctionIndex> seen_;
  std::vector<Entry> column_;
};

/// @param blocks of columns, in order.
Eigen::SparseMatrix<double> to_matrix(const std::vector<Columns>& blocks, std::size_t functions) {
  const auto n = static_cast<Eigen::Index>(functions);
  std::size_t count = 0;
  for (const Columns& block : blocks) count += block.entries.size();
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.reserve(static_cast<Eigen::Index>(count));
  Eigen::Index f = 0;
  for (const Columns& block : blocks) {
    std::size_t i = 0;
    for (const std::size_t end : block.ends) {
      matrix.startVec(f);
      for (; i < end; ++i) {
        const Entry& e = block.entries[i];
        matrix.insertBack(static_cast<Eigen::Index>(e.row), f) = e.value;
      }
      ++f;
    }
  }
  matrix.finalize();
  return matrix;
}

}  // namespace

NormalEquations assemble(const PixelValues& values, const image::Image& target,
                         std::span<const float> weights, std::span<const std::uint8_t> active) {
  const std::size_t functions = values.basis().space().function_count();
  const auto n = static_cast<Eigen::Index>(functions);
  NormalEquations normal;
  normal.right.setZero(n, target.channels);
  normal.matrix.resize(n, n);
  values.for_bands([&](const GridValues& grid, int begin, int end) {
    const TileIndex index(grid, active, values.width(), begin, end);
    const TileSums sums(grid, index, target, weights);
    const std::size_t block_size =
        std::max<std::size_t>(64, functions / 64);  // each clears a list of all functions
    std::vector<Columns> columns((functions + block_size - 1) / block_size);
    parallel_for(columns.size(), [&](std::size_t block) {
      ColumnSum column(functions);
      for (std::size_t i = block * block_size; i < std::min(functions, (block + 1) * block_size); ++i) {
        const auto f = static_cast<FunctionIndex>(i);
        column.add(f, index, sums, columns[block]);
        for (const TileIndex::Place place : index.places(f)) {
          for (Eigen::Index c = 0; c < target.channels; ++c)
            normal.right(static_cast<Eigen::Index>(f), c) += sums.right(place)[c];
        }
      }
    });
    const Eigen::SparseMatrix<double> band = to_matrix(columns, functions);
    normal.matrix = normal.matrix.nonZeros() == 0 ? band : Eigen::SparseMatrix<double>(normal.matrix + band);
  });
  return normal;
}

}  // namespace knotreel::fit
