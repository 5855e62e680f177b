#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>

#include "fit/pixel_values.h"

namespace knotreel::fit {

/// A^T A and A^T b of the least-squares problem A c = b, row = pixel, column = function.
struct NormalEquations {
  Eigen::SparseMatrix<double> matrix;  ///< lower triangle, functions x functions
  Eigen::MatrixXd right;               ///< functions x channels
};

/// Parallel over functions; same bits for any number of threads.
NormalEquations assemble(const PixelValues& values);

}  // namespace knotreel::fit
