// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <span>
#include <vector>

namespace knotreel::fit {

struct ColourSteps {
  double step = 1;                       ///< levels, more than 0
  std::span<const double> reluctance{};  ///< as ColourFitOptions::reluctance
  /// Of the mean of the diagonal: what is less counts as this for the reluctance. A change that few pixels
  /// ask for costs as many bytes as any other. 0 or more.
  double least_weight = 0.2;
};

/// Takes control points to multiples of a step such that all of them together are near the least of
/// c^T A c - 2 b^T c + step * sum of reluctance_i max(A_ii, least) |c_i - before_i|: each is rounded, then
/// one after the other goes to the multiple that is best given those around it, until none moves (a few
/// sweeps). So what is lost by rounding one is made up for by its neighbours, and one that is hardly better
/// elsewhere stays. In the sum, before_i is rounded too. Where there are colours, green goes first, and
/// before_i of red and blue moves as far as green has: light that changes is one change, as it is for
/// documents.
/// @param lower  the lower half of A, functions x functions; the diagonal is there and positive.
/// @param right  b, functions x channels.
/// @param moving one per function: 0 for those that are only rounded.
/// @param before control points, function by function, that these had; NaN: none. Or empty.
/// @param control the solution of A c = b or near it, as `before`; the result.
/// Parallel over channels but green; same bits for any number of threads.
/// @throws Error{kInvalidArgument} if sizes do not fit each other.
void descend_in_steps(const Eigen::SparseMatrix<double>& lower, const Eigen::MatrixXd& right,
                      std::span<const std::uint8_t> moving, std::span<const double> before,
                      const ColourSteps& options, std::vector<double>& control);

}  // namespace knotreel::fit
