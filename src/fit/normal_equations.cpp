#include "fit/normal_equations.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <numeric>

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

using spline::FunctionIndex;
using spline::GridValues;

/// Bounds of the pixels of a function, ends excluded: rows, columns and both diagonals, so that neighbours
/// whose boxes merely touch at their corners are told apart.
struct Box {
  std::int32_t left = 0;
  std::int32_t right = 0;
  std::int32_t top = 0;
  std::int32_t bottom = 0;
  std::int32_t sum_low = 0;  ///< of x + y
  std::int32_t sum_high = 0;
  std::int32_t difference_low = 0;  ///< of x - y
  std::int32_t difference_high = 0;

  bool empty() const { return left >= right || top >= bottom; }
  bool overlaps(const Box& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom &&
           sum_low < other.sum_high && other.sum_low < sum_high && difference_low < other.difference_high &&
           other.difference_low < difference_high;
  }
  void add(std::int32_t y, std::int32_t begin, std::int32_t end) {
    if (empty()) *this = {begin, end, y, y + 1, begin + y, end + y, begin - y, end - y};
    left = std::min(left, begin);
    right = std::max(right, end);
    bottom = y + 1;
    sum_low = std::min(sum_low, begin + y);
    sum_high = std::max(sum_high, end + y);
    difference_low = std::min(difference_low, begin - y);
    difference_high = std::max(difference_high, end - y);
  }
};

std::vector<Box> boxes_of(const GridValues& grid) {
  std::vector<Box> boxes(grid.row_begin.size() - 1);
  for (FunctionIndex f = 0; f < boxes.size(); ++f) {
    for (const GridValues::Row& row : grid.rows_of(f)) {
      if (row.x_begin < row.x_end) boxes[f].add(row.y, row.x_begin, row.x_end);
    }
  }
  return boxes;
}

/// Functions by square cells of pixels that their boxes touch.
class BoxIndex {
 public:
  BoxIndex(const std::vector<Box>& boxes, int width, int height)
      : boxes_(boxes),
        columns_(static_cast<std::size_t>(width / kCell) + 1),
        begin_(columns_ * (static_cast<std::size_t>(height / kCell) + 1) + 1, 0) {
    for (const Box& box : boxes_) for_cells(box, [&](std::size_t cell) { ++begin_[cell + 1]; });
    std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
    entries_.resize(begin_.back());
    std::vector<std::size_t> cursor(begin_.begin(), begin_.end() - 1);
    for (FunctionIndex f = 0; f < boxes_.size(); ++f) {
      for_cells(boxes_[f], [&](std::size_t cell) { entries_[cursor[cell]++] = f; });
    }
  }

  /// Functions from f on whose boxes overlap that of f, ascending.
  /// @param seen one per function, all kNoFunction at first; kept between calls.
  void later_neighbours(FunctionIndex f, std::vector<FunctionIndex>& seen,
                        std::vector<FunctionIndex>& out) const {
    out.clear();
    for_cells(boxes_[f], [&](std::size_t cell) {
      for (std::size_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
        const FunctionIndex g = entries_[i];
        if (g < f || seen[g] == f) continue;
        seen[g] = f;
        if (boxes_[g].overlaps(boxes_[f])) out.push_back(g);
      }
    });
    std::sort(out.begin(), out.end());
  }

 private:
  static constexpr int kCell = 16;

  template <class Visit>
  void for_cells(const Box& box, Visit&& visit) const {
    if (box.empty()) return;
    for (int y = box.top / kCell; y <= (box.bottom - 1) / kCell; ++y) {
      for (int x = box.left / kCell; x <= (box.right - 1) / kCell; ++x) {
        visit(static_cast<std::size_t>(y) * columns_ + static_cast<std::size_t>(x));
      }
    }
  }

  const std::vector<Box>& boxes_;
  std::size_t columns_;
  std::vector<std::size_t> begin_;
  std::vector<FunctionIndex> entries_;
};

/// Values times the weights of their pixels. Most functions have pixels of weight 1 only: their values serve
/// as they are.
class WeightedValues {
 public:
  /// Both must outlive this.
  WeightedValues(const GridValues& grid, std::span<const float> weights, int width)
      : grid_(grid), begin_(grid.row_begin.size(), 0) {
    if (weights.empty()) return;
    const std::size_t functions = grid.row_begin.size() - 1;
    std::vector<std::uint8_t> plain(functions);
    parallel_for(functions, [&](std::size_t f) {
      const auto rows = grid.rows_of(static_cast<FunctionIndex>(f));
      plain[f] = std::all_of(rows.begin(), rows.end(), [&](const GridValues::Row& row) {
        const auto w = weights_of(row, weights, width);
        return std::all_of(w.begin(), w.end(), [](float v) { return v == 1; });
      });
    });
    for (std::size_t f = 0; f < functions; ++f) {
      begin_[f + 1] = begin_[f] + (plain[f] ? 0 : size_of(grid.rows_of(static_cast<FunctionIndex>(f))));
    }
    values_.resize(begin_.back());
    parallel_for(functions, [&](std::size_t f) {
      if (plain[f]) return;
      const auto rows = grid.rows_of(static_cast<FunctionIndex>(f));
      for (const GridValues::Row& row : rows) {
        const double* from = grid.values.data() + row.offset;
        double* to = values_.data() + begin_[f] + (row.offset - rows.front().offset);
        for (const float w : weights_of(row, weights, width)) *to++ = *from++ * static_cast<double>(w);
      }
    });
  }

  /// Those of the first row of a function; the other rows follow as in the grid.
  const double* of(FunctionIndex f) const {
    if (begin_[f] < begin_[f + 1]) return values_.data() + begin_[f];
    return grid_.values.data() + grid_.rows_of(f).front().offset;
  }

 private:
  static std::span<const float> weights_of(const GridValues::Row& row, std::span<const float> weights,
                                           int width) {
    return weights.subspan(static_cast<std::size_t>(row.y) * std::size_t(width) + std::size_t(row.x_begin),
                           static_cast<std::size_t>(row.x_end - row.x_begin));
  }

  static std::size_t size_of(std::span<const GridValues::Row> rows) {
    const GridValues::Row& last = rows.back();
    return last.offset + static_cast<std::size_t>(last.x_end - last.x_begin) + GridValues::kPadding -
           rows.front().offset;
  }

  const GridValues& grid_;
  std::vector<std::size_t> begin_;
  std::vector<double> values_;
};

/// Four sums side by side: the order of additions is fixed, whatever the vector width.
using Lanes [[gnu::vector_size(4 * sizeof(double))]] = double;

/// Sum of the products of two functions over all pixels, the second one weighted: its values from the first
/// row on.
KNOTREEL_MULTIVERSION
double product(const GridValues& grid, const double* weighted, FunctionIndex f, FunctionIndex g) {
  const auto a = grid.rows_of(f);
  const auto b = grid.rows_of(g);
  const std::int32_t top = std::max(a.front().y, b.front().y);
  const std::int32_t bottom = std::min(a.back().y, b.back().y) + 1;
  const GridValues::Row* p = a.data() + (top - a.front().y);
  const GridValues::Row* q = b.data() + (top - b.front().y);
  Lanes sums{};
  for (std::int32_t y = top; y < bottom; ++y, ++p, ++q) {
    const std::int32_t from = std::max(p->x_begin, q->x_begin);
    const std::int32_t to = std::min(p->x_end, q->x_end);
    const double* u = grid.values.data() + p->offset + (from - p->x_begin);
    const double* v = weighted + (q->offset - b.front().offset) + (from - q->x_begin);
    // The last block may run into the padding of the row that ends first.
    for (std::int32_t x = from; x < to; x += 4, u += 4, v += 4) {
      Lanes s;
      Lanes t;
      std::memcpy(&s, u, sizeof s);
      std::memcpy(&t, v, sizeof t);
      sums += s * t;
    }
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

struct Entry {
  FunctionIndex row;
  double value;
};

/// The samples of a picture, padded to four channels.
using Samples = std::vector<std::array<float, 4>>;

Samples padded(const image::Image& image) {
  const auto channels = static_cast<std::size_t>(image.channels);
  Samples samples(image.pixel_count());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    for (std::size_t c = 0; c < channels; ++c) samples[i][c] = image.samples[i * channels + c];
  }
  return samples;
}

/// The sum over the pixels of a function of its weighted values times the samples.
KNOTREEL_MULTIVERSION
std::array<double, 4> product(std::span<const GridValues::Row> rows, const double* weighted,
                              const std::array<float, 4>* target, std::size_t width) {
  std::array<double, 4> sum{};
  for (const GridValues::Row& row : rows) {
    const double* v = weighted + (row.offset - rows.front().offset);
    const std::array<float, 4>* pixel =
        target + static_cast<std::size_t>(row.y) * width + static_cast<std::size_t>(row.x_begin);
    for (std::int32_t i = 0; i < row.x_end - row.x_begin; ++i) {
      for (std::size_t c = 0; c < 4; ++c) sum[c] += v[i] * static_cast<double>(pixel[i][c]);
    }
  }
  return sum;
}

Eigen::SparseMatrix<double> to_matrix(const std::vector<std::vector<Entry>>& columns) {
  const auto n = static_cast<Eigen::Index>(columns.size());
  Eigen::SparseMatrix<double> matrix(n, n);
  Eigen::VectorXi sizes(n);
  for (Eigen::Index f = 0; f < n; ++f)
    sizes[f] = static_cast<int>(columns[static_cast<std::size_t>(f)].size());
  matrix.reserve(sizes);
  for (Eigen::Index f = 0; f < n; ++f) {
    for (const Entry& e : columns[static_cast<std::size_t>(f)]) {
      matrix.insert(static_cast<Eigen::Index>(e.row), f) = e.value;
    }
  }
  matrix.makeCompressed();
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
  const Samples samples = padded(target);
  values.for_bands([&](const GridValues& grid, int, int) {
    const WeightedValues weighted(grid, weights, values.width());
    std::vector<Box> boxes = boxes_of(grid);
    for (std::size_t f = 0; f < active.size(); ++f) {
      if (!active[f]) boxes[f] = {};
    }
    const BoxIndex index(boxes, values.width(), values.height());
    std::vector<std::vector<Entry>> columns(functions);
    const std::size_t block_size =
        std::max<std::size_t>(64, functions / 64);  // each clears a list of all functions
    parallel_for((functions + block_size - 1) / block_size, [&](std::size_t block) {
      std::vector<FunctionIndex> neighbours;
      std::vector<FunctionIndex> seen(functions, spline::kNoFunction);
      for (std::size_t i = block * block_size; i < std::min(functions, (block + 1) * block_size); ++i) {
        const auto f = static_cast<FunctionIndex>(i);
        if (boxes[f].empty()) {
          columns[f].push_back({f, 0.0});
          continue;
        }
        index.later_neighbours(f, seen, neighbours);
        for (const FunctionIndex g : neighbours) {
          const double sum = product(grid, weighted.of(g), f, g);
          if (sum != 0 || g == f) columns[f].push_back({g, sum});
        }
        const std::array<double, 4> sum =
            product(grid.rows_of(f), weighted.of(f), samples.data(), static_cast<std::size_t>(target.width));
        for (Eigen::Index c = 0; c < target.channels; ++c) {
          normal.right(static_cast<Eigen::Index>(f), c) += sum[static_cast<std::size_t>(c)];
        }
      }
    });
    const Eigen::SparseMatrix<double> band = to_matrix(columns);
    normal.matrix = normal.matrix.nonZeros() == 0 ? band : Eigen::SparseMatrix<double>(normal.matrix + band);
  });
  return normal;
}

}  // namespace knotreel::fit
