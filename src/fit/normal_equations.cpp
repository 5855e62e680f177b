#include "fit/normal_equations.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "base/multiversion.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

using spline::FunctionIndex;
using spline::GridValues;

/// Pixels of a function: rows [top, bottom), columns [left, right).
struct Box {
  std::int32_t left = 0;
  std::int32_t right = 0;
  std::int32_t top = 0;
  std::int32_t bottom = 0;

  bool empty() const { return left >= right || top >= bottom; }
  bool overlaps(const Box& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
};

std::vector<Box> boxes_of(const GridValues& grid) {
  std::vector<Box> boxes(grid.row_begin.size() - 1);
  for (FunctionIndex f = 0; f < boxes.size(); ++f) {
    Box& box = boxes[f];
    for (const GridValues::Row& row : grid.rows_of(f)) {
      if (row.x_begin >= row.x_end) continue;
      if (box.empty()) box = {row.x_begin, row.x_end, row.y, row.y + 1};
      box.left = std::min(box.left, row.x_begin);
      box.right = std::max(box.right, row.x_end);
      box.bottom = row.y + 1;
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
  void later_neighbours(FunctionIndex f, std::vector<FunctionIndex>& out) const {
    out.clear();
    for_cells(boxes_[f], [&](std::size_t cell) {
      for (std::size_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
        if (entries_[i] >= f && boxes_[entries_[i]].overlaps(boxes_[f])) out.push_back(entries_[i]);
      }
    });
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
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

/// Weights of pixels, with quick answers where all are 1.
class Weights {
 public:
  Weights(std::span<const float> weights, int width) : weights_(weights), width_(std::size_t(width)) {
    if (weights_.empty()) return;
    special_.assign(weights_.size() + 1, 0);
    for (std::size_t i = 0; i < weights_.size(); ++i) special_[i + 1] = special_[i] + (weights_[i] != 1.0F);
  }

  /// Weights of pixels [from, to) of a row, or null if they are all 1.
  const float* row(std::int32_t y, std::int32_t from, std::int32_t to) const {
    if (weights_.empty()) return nullptr;
    const std::size_t start = static_cast<std::size_t>(y) * width_;
    const std::size_t first = start + static_cast<std::size_t>(from);
    return special_[start + static_cast<std::size_t>(to)] == special_[first] ? nullptr
                                                                             : weights_.data() + first;
  }

 private:
  std::span<const float> weights_;
  std::size_t width_;
  std::vector<std::uint32_t> special_;
};

/// Sum of w u v over n pixels, or of u v if w is null. Four sums side by side: the order is fixed, whatever
/// the vector width.
[[gnu::always_inline]] inline void add_products(const double* __restrict u, const double* __restrict v,
                                                const float* __restrict w, std::int32_t n,
                                                double* __restrict sums) {
  std::int32_t i = 0;
  if (w == nullptr) {
    for (; i + 4 <= n; i += 4) {
      for (std::int32_t l = 0; l < 4; ++l) sums[l] += u[i + l] * v[i + l];
    }
    for (std::int32_t l = 0; i < n; ++i, ++l) sums[l] += u[i] * v[i];
  } else {
    for (; i < n; ++i) sums[0] += static_cast<double>(w[i]) * u[i] * v[i];
  }
}

/// Sum of the products of two functions over all pixels.
KNOTREEL_MULTIVERSION
double product(const GridValues& grid, const Weights& weights, FunctionIndex f, FunctionIndex g) {
  const auto a = grid.rows_of(f);
  const auto b = grid.rows_of(g);
  const std::int32_t top = std::max(a.front().y, b.front().y);
  const std::int32_t bottom = std::min(a.back().y, b.back().y) + 1;
  double sums[4] = {};
  for (std::int32_t y = top; y < bottom; ++y) {
    const GridValues::Row& p = a[static_cast<std::size_t>(y - a.front().y)];
    const GridValues::Row& q = b[static_cast<std::size_t>(y - b.front().y)];
    const std::int32_t from = std::max(p.x_begin, q.x_begin);
    const std::int32_t to = std::min(p.x_end, q.x_end);
    if (from >= to) continue;
    add_products(grid.values.data() + p.offset + (from - p.x_begin),
                 grid.values.data() + q.offset + (from - q.x_begin), weights.row(y, from, to), to - from,
                 sums);
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

struct Entry {
  FunctionIndex row;
  double value;
};

/// Row f of A^T W b for one band.
void add_right(const GridValues& grid, const Weights& weights, const image::Image& target, FunctionIndex f,
               Eigen::MatrixXd& right) {
  const auto channels = static_cast<std::size_t>(target.channels);
  std::array<double, 4> sum{};
  for (const GridValues::Row& row : grid.rows_of(f)) {
    if (row.x_begin >= row.x_end) continue;
    const double* v = grid.values.data() + row.offset;
    const float* w = weights.row(row.y, row.x_begin, row.x_end);
    const float* pixel = target.row(row.y).data() + static_cast<std::size_t>(row.x_begin) * channels;
    for (std::int32_t i = 0; i < row.x_end - row.x_begin; ++i, pixel += channels) {
      const double weighted = w == nullptr ? v[i] : v[i] * static_cast<double>(w[i]);
      for (std::size_t c = 0; c < channels; ++c) sum[c] += weighted * static_cast<double>(pixel[c]);
    }
  }
  for (std::size_t c = 0; c < channels; ++c)
    right(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(c)) += sum[c];
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
  const Weights table(weights, values.width());
  NormalEquations normal;
  normal.right.setZero(n, target.channels);
  normal.matrix.resize(n, n);
  values.for_bands([&](const GridValues& grid, int, int) {
    std::vector<Box> boxes = boxes_of(grid);
    for (std::size_t f = 0; f < active.size(); ++f) {
      if (!active[f]) boxes[f] = {};
    }
    const BoxIndex index(boxes, values.width(), values.height());
    std::vector<std::vector<Entry>> columns(functions);
    constexpr std::size_t kBlock = 64;
    parallel_for((functions + kBlock - 1) / kBlock, [&](std::size_t block) {
      std::vector<FunctionIndex> neighbours;
      for (std::size_t i = block * kBlock; i < std::min(functions, (block + 1) * kBlock); ++i) {
        const auto f = static_cast<FunctionIndex>(i);
        if (boxes[f].empty()) {
          columns[f].push_back({f, 0.0});
          continue;
        }
        index.later_neighbours(f, neighbours);
        for (const FunctionIndex g : neighbours) {
          const double sum = product(grid, table, f, g);
          if (sum != 0 || g == f) columns[f].push_back({g, sum});
        }
        add_right(grid, table, target, f, normal.right);
      }
    });
    const Eigen::SparseMatrix<double> band = to_matrix(columns);
    normal.matrix = normal.matrix.nonZeros() == 0 ? band : Eigen::SparseMatrix<double>(normal.matrix + band);
  });
  return normal;
}

}  // namespace knotreel::fit
