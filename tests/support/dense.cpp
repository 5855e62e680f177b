// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/dense.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace knotreel::testing {

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a * b;
}

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.completeOrthogonalDecomposition().solve(b);
}

Eigen::MatrixXd solve_definite(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.llt().solve(b);
}

}  // namespace knotreel::testing
