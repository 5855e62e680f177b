// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/dense.h"

#include <Eigen/QR>

namespace knotreel::testing {

Eigen::MatrixXd product(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a * b;
}

Eigen::MatrixXd least_squares(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.colPivHouseholderQr().solve(b);
}

}  // namespace knotreel::testing
