// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>
#include <limits>
#include <optional>

namespace knotreel::fit {

struct GradientOptions {
  double tolerance = 0.01;  ///< largest change of x, in its unit, that the preconditioner still asks for
  int most_steps = 24;
  /// It is given up if more than that is asked for after half of the steps.
  double most_at_half = std::numeric_limits<double>::infinity();
};

/// Solves A x = b for all columns of b, 1 to 4, by conjugate gradients with an incomplete Cholesky factor of
/// A for preconditioner: without fill, and in the order of the unknowns, so that there is nothing to set up.
/// For systems whose solution is nearly known; one thread.
/// @param lower the lower half of A, which is symmetric and positive definite; rows ascend in each column,
/// and the diagonal is there. @param start near the solution, as large as b.
/// @return none if it takes more than most_steps, or A is too far from positive definite for such a factor.
std::optional<Eigen::MatrixXd> conjugate_gradients(const Eigen::SparseMatrix<double>& lower,
                                                   const Eigen::MatrixXd& right, const Eigen::MatrixXd& start,
                                                   const GradientOptions& options = {});

}  // namespace knotreel::fit
