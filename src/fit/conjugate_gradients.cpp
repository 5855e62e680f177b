// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/conjugate_gradients.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/multiversion.h"
#include "knotreel/base/error.h"

namespace knotreel::fit {

namespace {

using Matrix = Eigen::SparseMatrix<double>;

/// The lower half of a symmetric matrix by columns, the diagonal first in each.
struct Columns {
  const int* begin;
  const int* row;
  const double* value;
  int count;
};

/// Vectors with C numbers side by side for each unknown, one of each column of the right side.
using Vectors = std::vector<double>;
template <std::size_t C>
using Numbers = std::array<double, C>;

// As shares of the diagonal: what is added to it for the incomplete factor at first, ten times more while a
// pivot is less than the least one.
constexpr double kFirstShift = 1e-3;
constexpr double kMostShift = 0.2;
constexpr double kLeastPivot = 1e-2;

/// Column j of a factor loses its product with another column.
/// @param column that other one, scattered: by row, 0 where it has no entry.
[[gnu::always_inline]] inline void take_off(const int* __restrict row, int count,
                                            const double* __restrict column, double factor,
                                            double* __restrict values) {
  for (int i = 0; i < count; ++i) values[i] -= column[row[i]] * factor;
}

/// The incomplete Cholesky factor L of a matrix with a larger diagonal, with entries where A has some; but
/// 1 / L_kk on the diagonal. Empty if a pivot is too small.
KNOTREEL_MULTIVERSION
std::vector<double> incomplete_factor(const Columns& a, double shift) {
  std::vector<double> l(a.value, a.value + a.begin[a.count]);
  std::vector<double> column(static_cast<std::size_t>(a.count), 0.0);
  for (int k = 0; k < a.count; ++k) l[std::size_t(a.begin[k])] *= 1 + shift;
  for (int k = 0; k < a.count; ++k) {
    const int first = a.begin[k];
    const int last = a.begin[k + 1];
    if (!(l[std::size_t(first)] > kLeastPivot * a.value[first])) return {};
    l[std::size_t(first)] = 1 / std::sqrt(l[std::size_t(first)]);
    for (int i = first + 1; i < last; ++i) {
      l[std::size_t(i)] *= l[std::size_t(first)];
      column[std::size_t(a.row[i])] = l[std::size_t(i)];
    }
    for (int j = first + 1; j < last; ++j) {
      const int begin = a.begin[a.row[j]];
      take_off(a.row + begin, a.begin[a.row[j] + 1] - begin, column.data(), l[std::size_t(j)],
               l.data() + begin);
    }
    for (int i = first + 1; i < last; ++i) column[std::size_t(a.row[i])] = 0;
  }
  return l;
}

/// out = A v.
template <std::size_t C>
[[gnu::always_inline]] inline void multiply(const Columns& a, const double* __restrict v,
                                            double* __restrict out) {
  std::fill_n(out, std::size_t(a.count) * C, 0.0);
  for (int j = 0; j < a.count; ++j) {
    const double* vj = v + std::size_t(j) * C;
    const double diagonal = a.value[a.begin[j]];
    Numbers<C> sum;
    for (std::size_t c = 0; c < C; ++c) sum[c] = diagonal * vj[c];
    for (int k = a.begin[j] + 1; k < a.begin[j + 1]; ++k) {
      const double* vi = v + std::size_t(a.row[k]) * C;
      double* oi = out + std::size_t(a.row[k]) * C;
      for (std::size_t c = 0; c < C; ++c) {
        oi[c] += a.value[k] * vj[c];
        sum[c] += a.value[k] * vi[c];
      }
    }
    for (std::size_t c = 0; c < C; ++c) out[std::size_t(j) * C + c] += sum[c];
  }
}

/// L L^T v = v. @param l as `a`, but with the values of incomplete_factor().
template <std::size_t C>
[[gnu::always_inline]] inline void precondition(const Columns& l, double* v) {
  for (int j = 0; j < l.count; ++j) {
    double* vj = v + std::size_t(j) * C;
    Numbers<C> x;
    for (std::size_t c = 0; c < C; ++c) vj[c] = x[c] = vj[c] * l.value[l.begin[j]];
    for (int k = l.begin[j] + 1; k < l.begin[j + 1]; ++k) {
      double* vi = v + std::size_t(l.row[k]) * C;
      for (std::size_t c = 0; c < C; ++c) vi[c] -= l.value[k] * x[c];
    }
  }
  for (int j = l.count - 1; j >= 0; --j) {
    double* vj = v + std::size_t(j) * C;
    Numbers<C> x;
    for (std::size_t c = 0; c < C; ++c) x[c] = vj[c];
    for (int k = l.begin[j] + 1; k < l.begin[j + 1]; ++k) {
      const double* vi = v + std::size_t(l.row[k]) * C;
      for (std::size_t c = 0; c < C; ++c) x[c] -= l.value[k] * vi[c];
    }
    for (std::size_t c = 0; c < C; ++c) vj[c] = x[c] * l.value[l.begin[j]];
  }
}

template <std::size_t C>
[[gnu::always_inline]] inline Numbers<C> products(const Vectors& a, const Vectors& b) {
  Numbers<C> sum{};
  for (std::size_t i = 0; i < a.size(); i += C) {
    for (std::size_t c = 0; c < C; ++c) sum[c] += a[i + c] * b[i + c];
  }
  return sum;
}

template <std::size_t C>
[[gnu::always_inline]] inline bool descend(const Columns& a, const Columns& l, const GradientOptions& options,
                                           Vectors& x, Vectors& residual) {
  Vectors along(x.size());  // A times something
  multiply<C>(a, x.data(), along.data());
  for (std::size_t i = 0; i < x.size(); ++i) residual[i] -= along[i];
  Vectors wanted = residual;  // change of x
  precondition<C>(l, wanted.data());
  Vectors direction = wanted;
  Numbers<C> product = products<C>(residual, wanted);
  for (int step = 0; step <= options.most_steps; ++step) {
    if (!std::all_of(product.begin(), product.end(), [](double p) { return std::isfinite(p); })) return false;
    double largest = 0;
    for (const double w : wanted) largest = std::max(largest, std::abs(w));
    if (largest <= options.tolerance) {
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += wanted[i];
      return true;
    }
    if (2 * step == options.most_steps && largest > options.most_at_half) return false;
    multiply<C>(a, direction.data(), along.data());
    const Numbers<C> energy = products<C>(direction, along);
    Numbers<C> length{};  // none for a column that is solved
    for (std::size_t c = 0; c < C; ++c) length[c] = energy[c] > 0 ? product[c] / energy[c] : 0;
    for (std::size_t i = 0; i < x.size(); i += C) {
      for (std::size_t c = 0; c < C; ++c) {
        x[i + c] += length[c] * direction[i + c];
        residual[i + c] -= length[c] * along[i + c];
      }
    }
    wanted = residual;
    precondition<C>(l, wanted.data());
    const Numbers<C> next = products<C>(residual, wanted);
    Numbers<C> keep{};
    for (std::size_t c = 0; c < C; ++c) keep[c] = product[c] > 0 ? next[c] / product[c] : 0;
    for (std::size_t i = 0; i < x.size(); i += C) {
      for (std::size_t c = 0; c < C; ++c) direction[i + c] = wanted[i + c] + keep[c] * direction[i + c];
    }
    product = next;
  }
  return false;
}

KNOTREEL_MULTIVERSION
bool descend(const Columns& a, const Columns& l, const GradientOptions& options, Vectors& x,
             Vectors& residual, Eigen::Index columns) {
  switch (columns) {
    case 1:
      return descend<1>(a, l, options, x, residual);
    case 2:
      return descend<2>(a, l, options, x, residual);
    case 3:
      return descend<3>(a, l, options, x, residual);
    default:
      return descend<4>(a, l, options, x, residual);
  }
}

using SideBySide = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Vectors side_by_side(const Eigen::MatrixXd& matrix) {
  Vectors numbers(static_cast<std::size_t>(matrix.size()));
  Eigen::Map<SideBySide>(numbers.data(), matrix.rows(), matrix.cols()) = matrix;
  return numbers;
}

}  // namespace

std::optional<Eigen::MatrixXd> conjugate_gradients(const Matrix& lower, const Eigen::MatrixXd& right,
                                                   const Eigen::MatrixXd& start,
                                                   const GradientOptions& options) {
  if (right.cols() < 1 || right.cols() > 4 || right.rows() != lower.rows() || start.rows() != right.rows() ||
      start.cols() != right.cols())
    throw Error(ErrorKind::kInvalidArgument, "sizes of a linear system do not fit each other");
  const Columns a{lower.outerIndexPtr(), lower.innerIndexPtr(), lower.valuePtr(),
                  static_cast<int>(lower.cols())};
  std::vector<double> factor;
  for (double shift = kFirstShift; factor.empty() && shift < kMostShift; shift *= 10)
    factor = incomplete_factor(a, shift);
  if (factor.empty()) return std::nullopt;
  Columns l = a;
  l.value = factor.data();
  Vectors x = side_by_side(start);
  Vectors residual = side_by_side(right);
  if (!descend(a, l, options, x, residual, right.cols())) return std::nullopt;
  return Eigen::Map<const SideBySide>(x.data(), right.rows(), right.cols());
}

}  // namespace knotreel::fit
