// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/reduced_system.h"

#include <Eigen/CholmodSupport>
#include <algorithm>
#include <numeric>
#include <optional>

#include "fit/conjugate_gradients.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

using Matrix = Eigen::SparseMatrix<double>;
using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

struct Share {
  int row;
  double value;
};

/// By row of P: the column whose 1 is all there is in it, or kNone.
constexpr int kNone = -1;
std::vector<int> unit_columns(const RowMatrix& p) {
  std::vector<int> columns(static_cast<std::size_t>(p.rows()), kNone);
  for (int i = 0; i < p.rows(); ++i) {
    const RowMatrix::InnerIterator first(p, i);
    const int count = p.outerIndexPtr()[i + 1] - p.outerIndexPtr()[i];
    if (count == 1 && first.value() == 1)
      columns[static_cast<std::size_t>(i)] = static_cast<int>(first.col());
  }
  return columns;
}

/// Calls visit(row, column, value) for all shares of the lower half of P^T A P, in a fixed order.
template <class Visit>
void for_shares(const Matrix& lower, const RowMatrix& p, const std::vector<int>& units, Visit&& visit) {
  for (int j = 0; j < lower.outerSize(); ++j) {
    const int unit_j = units[static_cast<std::size_t>(j)];
    for (Matrix::InnerIterator entry(lower, j); entry; ++entry) {
      const int i = static_cast<int>(entry.row());
      const int unit_i = units[static_cast<std::size_t>(i)];
      if (unit_i != kNone && unit_j != kNone && (i == j || unit_i != unit_j)) {
        visit(std::max(unit_i, unit_j), std::min(unit_i, unit_j), entry.value());
        continue;
      }
      for (RowMatrix::InnerIterator a(p, i); a; ++a) {
        for (RowMatrix::InnerIterator b(p, j); b; ++b) {
          const int r = static_cast<int>(a.col());
          const int c = static_cast<int>(b.col());
          if (i == j && r < c) continue;
          // The share of the upper half of A falls on the diagonal too.
          const double twice = r == c && i != j ? 2.0 : 1.0;
          visit(std::max(r, c), std::min(r, c), twice * a.value() * entry.value() * b.value());
        }
      }
    }
  }
}

/// Sums up the shares [begin, end) of a column that have the same row, in the order that they have, and puts
/// them in the order of rows. @param places by row, any values. @return the new end.
std::size_t sum_up(std::vector<Share>& shares, std::size_t begin, std::size_t end,
                   std::vector<std::size_t>& places) {
  std::size_t to = begin;
  bool in_order = true;
  for (std::size_t from = begin; from < end; ++from) {
    const Share share = shares[from];
    std::size_t& place = places[static_cast<std::size_t>(share.row)];
    if (place >= begin && place < to && shares[place].row == share.row) {
      shares[place].value += share.value;
      continue;
    }
    place = to;
    in_order = in_order && (to == begin || shares[to - 1].row < share.row);
    shares[to++] = share;
  }
  if (!in_order) {
    std::sort(shares.begin() + static_cast<std::ptrdiff_t>(begin),
              shares.begin() + static_cast<std::ptrdiff_t>(to),
              [](const Share& a, const Share& b) { return a.row < b.row; });
  }
  return to;
}

/// The lower half of P^T A P. Most rows of P are those of the identity, which products of sparse matrices
/// do not make use of.
Matrix reduce(const Matrix& lower, const RowMatrix& p) {
  const auto n = static_cast<std::size_t>(p.cols());
  const std::vector<int> units = unit_columns(p);
  std::vector<std::size_t> begin(n + 1, 0);
  for_shares(lower, p, units, [&](int, int c, double) { ++begin[static_cast<std::size_t>(c) + 1]; });
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Share> entries(begin.back());
  std::vector<std::size_t> end(begin.begin(), begin.end() - 1);
  for_shares(lower, p, units, [&](int r, int c, double v) {
    entries[end[static_cast<std::size_t>(c)]++] = {r, v};
  });
  constexpr std::size_t kColumns = 256;
  parallel_for((n + kColumns - 1) / kColumns, [&](std::size_t block) {
    thread_local std::vector<std::size_t> places;  // by row, of whatever column was last to have it
    places.resize(std::max(places.size(), n));
    for (std::size_t c = block * kColumns; c < std::min(n, (block + 1) * kColumns); ++c)
      end[c] = sum_up(entries, begin[c], end[c], places);
  });
  Matrix reduced(p.cols(), p.cols());
  std::size_t count = 0;
  for (std::size_t c = 0; c < n; ++c) count += end[c] - begin[c];
  reduced.resizeNonZeros(static_cast<Eigen::Index>(count));
  count = 0;
  for (std::size_t c = 0; c < n; ++c) {
    reduced.outerIndexPtr()[c] = static_cast<int>(count);
    for (std::size_t i = begin[c]; i < end[c]; ++i, ++count) {
      reduced.innerIndexPtr()[count] = entries[i].row;
      reduced.valuePtr()[count] = entries[i].value;
    }
  }
  reduced.outerIndexPtr()[n] = static_cast<int>(count);
  return reduced;
}

/// Some z with P z near x: exact for the columns that are alone in a row.
Eigen::MatrixXd reduced_start(const RowMatrix& p, const Eigen::MatrixXd& x) {
  Eigen::MatrixXd z = p.transpose() * x;
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(p.cols());
  for (int i = 0; i < p.rows(); ++i) {
    for (RowMatrix::InnerIterator a(p, i); a; ++a) squares[a.col()] += a.value() * a.value();
  }
  z.array().colwise() /= squares.array();
  const std::vector<int> units = unit_columns(p);
  for (std::size_t i = 0; i < units.size(); ++i) {
    if (units[i] != kNone) z.row(units[i]) = x.row(static_cast<Eigen::Index>(i));
  }
  return z;
}

// To factor a system takes as long as some 20 steps where it is small, and as 80 where it is large.
constexpr Eigen::Index kLarge = 10'000;
constexpr int kFewSteps = 24;
constexpr int kMoreSteps = 48;
// Times the tolerance, after half of these: those that arrived were at most 12 times as far off then, those
// that did not 47 times at least.
constexpr double kFarAtHalf = 30;

GradientOptions gradient_options(Eigen::Index unknowns, double tolerance) {
  if (unknowns < kLarge) return {.tolerance = tolerance, .most_steps = kFewSteps};
  return {.tolerance = tolerance, .most_steps = kMoreSteps, .most_at_half = kFarAtHalf * tolerance};
}

}  // namespace

Eigen::MatrixXd solve_reduced(const Matrix& lower, const Matrix& p, const Eigen::MatrixXd& right,
                              const Eigen::MatrixXd& start, double tolerance) {
  const RowMatrix rows(p);
  const Matrix reduced = reduce(lower, rows);
  if (start.size() > 0) {
    const std::optional<Eigen::MatrixXd> z =
        conjugate_gradients(reduced, p.transpose() * right, reduced_start(rows, start),
                            gradient_options(reduced.cols(), tolerance));
    if (z) return p * *z;
  }
  const Eigen::CholmodSimplicialLDLT<Matrix, Eigen::Lower> factor(reduced);
  if (factor.info() != Eigen::Success) {
    throw Error(ErrorKind::kInternal, "the normal equations of the colour fit cannot be factored");
  }
  const Eigen::MatrixXd z = factor.solve(p.transpose() * right);
  return p * z;
}

}  // namespace knotreel::fit
