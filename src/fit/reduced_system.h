#pragma once

#include <Eigen/SparseCore>

namespace knotreel::fit {

/// Solves P^T A P z = P^T b for all columns of b.
/// @param lower the lower half of A, which is symmetric and positive definite. @param p full column rank.
/// @return P z.
/// @throws Error{kInternal} if the matrix cannot be factored.
Eigen::MatrixXd solve_reduced(const Eigen::SparseMatrix<double>& lower, const Eigen::SparseMatrix<double>& p,
                              const Eigen::MatrixXd& right);

}  // namespace knotreel::fit
