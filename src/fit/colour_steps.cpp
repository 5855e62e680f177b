// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/colour_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"

namespace knotreel::fit {

namespace {

constexpr int kMostSweeps = 4;  // later ones move one in a thousand
constexpr std::size_t kGreen = 1;
constexpr double kGreenLeads = 4.0 / 3;  // the reluctance that it has for all three, where there are colours

/// A symmetric matrix by rows, without its diagonal.
struct Rows {
  std::vector<double> diagonal;
  std::vector<std::size_t> begin;
  std::vector<int> column;
  std::vector<double> value;
};

template <class Visit>
void for_entries(const Eigen::SparseMatrix<double>& lower, Visit&& visit) {
  for (int j = 0; j < lower.outerSize(); ++j) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(lower, j); entry; ++entry)
      visit(static_cast<std::size_t>(entry.row()), static_cast<std::size_t>(j), entry.value());
  }
}

Rows rows_of(const Eigen::SparseMatrix<double>& lower) {
  const auto n = static_cast<std::size_t>(lower.cols());
  Rows rows{std::vector<double>(n), std::vector<std::size_t>(n + 1), {}, {}};
  for_entries(lower, [&](std::size_t i, std::size_t j, double) {
    if (i == j) return;
    ++rows.begin[i + 1];
    ++rows.begin[j + 1];
  });
  std::partial_sum(rows.begin.begin(), rows.begin.end(), rows.begin.begin());
  rows.column.resize(rows.begin.back());
  rows.value.resize(rows.begin.back());
  std::vector<std::size_t> end(rows.begin.begin(), rows.begin.end() - 1);
  const auto add = [&](std::size_t row, std::size_t column, double value) {
    rows.column[end[row]] = static_cast<int>(column);
    rows.value[end[row]++] = value;
  };
  for_entries(lower, [&](std::size_t i, std::size_t j, double value) {
    if (i == j) {
      rows.diagonal[i] = value;
      return;
    }
    add(i, j, value);
    add(j, i, value);
  });
  return rows;
}

/// The multiple, counted in steps, that is best for one control point.
/// @param best where it would be without steps and reluctance. @param before NaN: none.
double best_multiple(double best, double before, double reluctance) {
  if (std::isnan(before)) return std::round(best);
  const double away = std::max(0.0, std::abs(best - before) - reluctance / 2);
  return before + std::copysign(std::round(away), best - before);
}

/// By function, in steps.
std::vector<double> reluctance_of(const std::vector<double>& diagonal, const ColourSteps& options) {
  const double sum = std::accumulate(diagonal.begin(), diagonal.end(), 0.0);
  const double least = options.least_weight * sum / static_cast<double>(diagonal.size());
  std::vector<double> result(options.reluctance.begin(), options.reluctance.end());
  result.resize(diagonal.size(), 0.0);
  for (std::size_t i = 0; i < result.size(); ++i) result[i] *= std::max(1.0, least / diagonal[i]);
  return result;
}

/// One channel. Everything is counted in steps.
void descend(const Rows& a, std::span<const std::uint8_t> moving, const std::vector<double>& before,
             const std::vector<double>& reluctance, std::vector<double>& x, std::vector<double>& residual) {
  const std::size_t n = x.size();
  for (double& v : x) v = std::round(v);
  for (std::size_t i = 0; i < n; ++i) {
    double sum = a.diagonal[i] * x[i];
    for (std::size_t k = a.begin[i]; k < a.begin[i + 1]; ++k)
      sum += a.value[k] * x[static_cast<std::size_t>(a.column[k])];
    residual[i] -= sum;
  }
  bool any = true;
  for (int sweep = 0; any && sweep < kMostSweeps; ++sweep) {
    any = false;
    for (std::size_t i = 0; i < n; ++i) {
      if (!moving[i]) continue;
      const double to = best_multiple(x[i] + residual[i] / a.diagonal[i], before[i], reluctance[i]);
      const double change = to - x[i];
      if (change == 0) continue;
      any = true;
      x[i] = to;
      residual[i] -= a.diagonal[i] * change;
      for (std::size_t k = a.begin[i]; k < a.begin[i + 1]; ++k)
        residual[static_cast<std::size_t>(a.column[k])] -= a.value[k] * change;
    }
  }
}

}  // namespace

void descend_in_steps(const Eigen::SparseMatrix<double>& lower, const Eigen::MatrixXd& right,
                      std::span<const std::uint8_t> moving, std::span<const double> before,
                      const ColourSteps& options, std::vector<double>& control) {
  const auto n = static_cast<std::size_t>(lower.cols());
  const auto channels = static_cast<std::size_t>(right.cols());
  if (static_cast<std::size_t>(right.rows()) != n || moving.size() != n || control.size() != n * channels ||
      (!before.empty() && before.size() != control.size()) ||
      (!options.reluctance.empty() && options.reluctance.size() != n))
    throw Error(ErrorKind::kInvalidArgument, "sizes of a linear system do not fit each other");
  const Rows rows = rows_of(lower);
  const std::vector<double> reluctance = reluctance_of(rows.diagonal, options);
  std::vector<double> of_green = reluctance;
  if (channels >= 3) {
    for (double& r : of_green) r *= kGreenLeads;
  }
  std::vector<double> lead(n, 0.0);  // how far green goes, in steps
  const auto descend_channel = [&](std::size_t c, bool follows) {
    std::vector<double> x(n);
    std::vector<double> residual(n);
    std::vector<double> old(n, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = control[i * channels + c] / options.step;
      residual[i] = right(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(c)) / options.step;
      if (!before.empty()) old[i] = std::round(before[i * channels + c] / options.step);
      if (follows) old[i] += lead[i];
    }
    descend(rows, moving, old, c == kGreen ? of_green : reluctance, x, residual);
    for (std::size_t i = 0; i < n; ++i) control[i * channels + c] = x[i] * options.step;
    if (channels < 3 || c != kGreen) return;
    for (std::size_t i = 0; i < n; ++i) lead[i] = std::isnan(old[i]) ? 0 : x[i] - old[i];
  };
  if (channels < 3) return parallel_for(channels, [&](std::size_t c) { descend_channel(c, false); });
  descend_channel(kGreen, false);
  parallel_for(channels - 1, [&](std::size_t i) {
    const std::size_t c = i < kGreen ? i : i + 1;
    descend_channel(c, c < 3);
  });
}

}  // namespace knotreel::fit
