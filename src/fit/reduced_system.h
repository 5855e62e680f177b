// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>

namespace knotreel::fit {

/// Solves P^T A P z = P^T b for all columns of b.
/// @param lower the lower half of A, which is symmetric and positive definite. @param p full column rank.
/// @param start near the solution P z: it is found from there, as near as GradientOptions::tolerance; or
/// empty: to the last bit.
/// @return P z.
/// @throws Error{kInternal} if the matrix cannot be factored.
Eigen::MatrixXd solve_reduced(const Eigen::SparseMatrix<double>& lower, const Eigen::SparseMatrix<double>& p,
                              const Eigen::MatrixXd& right, const Eigen::MatrixXd& start = {},
                              double tolerance = 0.01);

}  // namespace knotreel::fit
