#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>

#include "knotreel/image/image.h"
#include "knotreel/spline/basis.h"

namespace knotreel::fit {

/// A^T A and A^T b of the least-squares problem A c = b, row = pixel, column = function, from values on a grid.
struct NormalEquations {
  Eigen::SparseMatrix<double> matrix;  ///< lower triangle, functions x functions
  Eigen::MatrixXd right;               ///< functions x channels
};

/// @param grid  values at the centres of the image's pixels. Parallel over functions; same bits for any number.
NormalEquations assemble(const spline::GridValues& grid, const image::Image& image);

}  // namespace knotreel::fit
