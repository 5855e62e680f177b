#include "fit/normal_equations.h"

#include <algorithm>
#include <numeric>

#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

using spline::FunctionIndex;
using spline::GridValues;

/// For each pixel row, the function rows in it, by function.
class RowIndex {
 public:
  struct Entry {
    FunctionIndex function;
    const GridValues::Row* row;
  };

  RowIndex(const GridValues& grid, int rows) : begin_(static_cast<std::size_t>(rows) + 1, 0) {
    for (const GridValues::Row& r : grid.rows) ++begin_[static_cast<std::size_t>(r.y) + 1];
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    entries_.resize(grid.rows.size());
    std::vector<std::size_t> cursor(begin_.begin(), begin_.end() - 1);
    for (FunctionIndex f = 0; f + 1 < grid.row_begin.size(); ++f) {
      for (const GridValues::Row& r : grid.rows_of(f))
        entries_[cursor[static_cast<std::size_t>(r.y)]++] = {f, &r};
    }
    for (std::size_t y = 0; y + 1 < begin_.size(); ++y) {
      std::int32_t longest = 0;
      const auto first = entries_.begin() + static_cast<std::ptrdiff_t>(begin_[y]);
      const auto last = entries_.begin() + static_cast<std::ptrdiff_t>(begin_[y + 1]);
      std::sort(first, last, [](const Entry& a, const Entry& b) {
        return a.row->x_begin != b.row->x_begin ? a.row->x_begin < b.row->x_begin : a.function < b.function;
      });
      for (auto it = first; it != last; ++it) longest = std::max(longest, it->row->x_end - it->row->x_begin);
      longest_.push_back(longest);
    }
  }

  /// Calls visit for every function whose values in this row share pixels with `row`.
  template <class Visit>
  void for_overlapping(const GridValues::Row& row, Visit&& visit) const {
    const auto y = static_cast<std::size_t>(row.y);
    const auto first = entries_.begin() + static_cast<std::ptrdiff_t>(begin_[y]);
    const auto last = entries_.begin() + static_cast<std::ptrdiff_t>(begin_[y + 1]);
    auto it = std::lower_bound(first, last, row.x_begin - longest_[y],
                               [](const Entry& e, std::int32_t x) { return e.row->x_begin < x; });
    for (; it != last && it->row->x_begin < row.x_end; ++it) {
      if (it->row->x_end > row.x_begin) visit(*it);
    }
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<Entry> entries_;
  std::vector<std::int32_t> longest_;
};

double dot_rows(const GridValues& grid, const GridValues::Row& a, const GridValues::Row& b) {
  const std::int32_t from = std::max(a.x_begin, b.x_begin);
  const std::int32_t to = std::min(a.x_end, b.x_end);
  const double* p = grid.values.data() + a.offset + (from - a.x_begin);
  const double* q = grid.values.data() + b.offset + (from - b.x_begin);
  double sum = 0;
  for (std::int32_t i = 0; i < to - from; ++i) sum += p[i] * q[i];
  return sum;
}

/// Adds the products of one band of rows.
void add_band(const GridValues& grid, const image::Image& image, std::vector<Eigen::Triplet<double>>& entries,
              Eigen::MatrixXd& right) {
  const std::size_t functions = grid.row_begin.size() - 1;
  const RowIndex index(grid, image.height);
  std::vector<std::vector<Eigen::Triplet<double>>> columns(functions);

  // Blocks of functions share a dense accumulator; few blocks, because each clears one as long as all
  // functions.
  const std::size_t block_size = std::max<std::size_t>(64, functions / 64);
  parallel_for((functions + block_size - 1) / block_size, [&](std::size_t block) {
    std::vector<double> sum(functions, 0.0);
    std::vector<FunctionIndex> touched;
    std::vector<bool> seen(functions, false);
    for (std::size_t k = block * block_size; k < std::min(functions, (block + 1) * block_size); ++k) {
      const auto f = static_cast<FunctionIndex>(k);
      touched.clear();
      for (const GridValues::Row& row : grid.rows_of(f)) {
        index.for_overlapping(row, [&](const RowIndex::Entry& e) {
          if (e.function < f) return;
          if (!seen[e.function]) {
            seen[e.function] = true;
            touched.push_back(e.function);
          }
          sum[e.function] += dot_rows(grid, row, *e.row);
        });
        const float* pixels = image.row(row.y).data();
        for (std::int32_t x = row.x_begin; x < row.x_end; ++x) {
          const double v = grid.values[row.offset + static_cast<std::size_t>(x - row.x_begin)];
          for (int c = 0; c < image.channels; ++c) {
            right(static_cast<Eigen::Index>(f), c) += v * static_cast<double>(pixels[x * image.channels + c]);
          }
        }
      }
      std::sort(touched.begin(), touched.end());
      for (const FunctionIndex g : touched) {
        if (sum[g] != 0) columns[f].emplace_back(g, f, sum[g]);
        sum[g] = 0;
        seen[g] = false;
      }
    }
  });
  for (const auto& column : columns) entries.insert(entries.end(), column.begin(), column.end());
}

// Pixels of a band: about 250 MB of values.
constexpr int kBandPixels = 1 << 22;

}  // namespace

NormalEquations assemble(const spline::Basis& basis, const image::Image& image) {
  const auto functions = static_cast<Eigen::Index>(basis.space().function_count());
  NormalEquations normal;
  normal.right.setZero(functions, image.channels);
  std::vector<Eigen::Triplet<double>> entries;
  // The diagonal is always there, so that a ridge has a place.
  for (Eigen::Index f = 0; f < functions; ++f) entries.emplace_back(f, f, 0.0);
  const int band = std::max(1, kBandPixels / image.width);
  for (int y = 0; y < image.height; y += band) {
    const int end = std::min(image.height, y + band);
    add_band(basis.evaluate_grid_rows(image.width, image.height, y, end), image, entries, normal.right);
  }
  normal.matrix.resize(functions, functions);
  normal.matrix.setFromTriplets(entries.begin(), entries.end());
  return normal;
}

}  // namespace knotreel::fit
