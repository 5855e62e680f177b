#include "fit/normal_equations.h"

#include <algorithm>
#include <numeric>

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

/// Sum of the products of two functions over all pixels.
double product(const GridValues& grid, FunctionIndex f, FunctionIndex g) {
  const auto a = grid.rows_of(f);
  const auto b = grid.rows_of(g);
  const std::int32_t top = std::max(a.front().y, b.front().y);
  const std::int32_t bottom = std::min(a.back().y, b.back().y) + 1;
  double sum = 0;
  for (std::int32_t y = top; y < bottom; ++y) {
    const GridValues::Row& p = a[static_cast<std::size_t>(y - a.front().y)];
    const GridValues::Row& q = b[static_cast<std::size_t>(y - b.front().y)];
    const std::int32_t from = std::max(p.x_begin, q.x_begin);
    const std::int32_t to = std::min(p.x_end, q.x_end);
    const double* u = grid.values.data() + p.offset + (from - p.x_begin);
    const double* v = grid.values.data() + q.offset + (from - q.x_begin);
    for (std::int32_t i = 0; i < to - from; ++i) sum += u[i] * v[i];
  }
  return sum;
}

struct Entry {
  FunctionIndex row;
  double value;
};

/// Column f of the lower triangle of A^T A, and row f of A^T b, for one band.
void add_function(const PixelValues& values, const GridValues& grid, const BoxIndex& index, FunctionIndex f,
                  std::vector<Entry>& column, Eigen::MatrixXd& right) {
  thread_local std::vector<FunctionIndex> neighbours;
  index.later_neighbours(f, neighbours);
  for (const FunctionIndex g : neighbours) {
    const double sum = product(grid, f, g);
    if (sum != 0) column.push_back({g, sum});
  }
  const image::Image& image = values.image();
  const bool weighted = !values.pixels().weights.empty();
  for (const GridValues::Row& row : grid.rows_of(f)) {
    const float* pixels = image.row(row.y).data();
    for (std::int32_t x = row.x_begin; x < row.x_end; ++x) {
      double v = grid.values[row.offset + static_cast<std::size_t>(x - row.x_begin)];
      if (weighted) v *= values.root_weight(x, row.y);
      for (int c = 0; c < image.channels; ++c) {
        right(static_cast<Eigen::Index>(f), c) += v * static_cast<double>(pixels[x * image.channels + c]);
      }
    }
  }
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

NormalEquations assemble(const PixelValues& values) {
  const std::size_t functions = values.basis().space().function_count();
  const auto n = static_cast<Eigen::Index>(functions);
  NormalEquations normal;
  normal.right.setZero(n, values.image().channels);
  normal.matrix.resize(n, n);
  values.for_bands([&](const GridValues& grid, int, int) {
    const std::vector<Box> boxes = boxes_of(grid);
    const BoxIndex index(boxes, values.image().width, values.image().height);
    std::vector<std::vector<Entry>> columns(functions);
    constexpr std::size_t kBlock = 64;
    parallel_for((functions + kBlock - 1) / kBlock, [&](std::size_t block) {
      for (std::size_t f = block * kBlock; f < std::min(functions, (block + 1) * kBlock); ++f) {
        add_function(values, grid, index, static_cast<FunctionIndex>(f), columns[f], normal.right);
        // The diagonal is always there, so that a ridge has a place.
        if (columns[f].empty() || columns[f].front().row != f) {
          columns[f].insert(columns[f].begin(), {static_cast<FunctionIndex>(f), 0.0});
        }
      }
    });
    const Eigen::SparseMatrix<double> band = to_matrix(columns);
    normal.matrix = normal.matrix.nonZeros() == 0 ? band : Eigen::SparseMatrix<double>(normal.matrix + band);
  });
  return normal;
}

}  // namespace knotreel::fit
