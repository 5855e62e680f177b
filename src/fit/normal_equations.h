#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>

#include "knotreel/image/image.h"
#include "knotreel/spline/basis.h"

namespace knotreel::fit {

/// A^T A and A^T b of the least-squares problem A c = b, row = pixel, column = function, from values on a
/// grid.
struct NormalEquations {
  Eigen::SparseMatrix<double> matrix;  ///< lower triangle, functions x functions
  Eigen::MatrixXd right;               ///< functions x channels
};

/// For the values of the basis functions at the centres of the image's pixels. The picture is taken in bands
/// of rows, so that the values held at one time do not grow with it. Parallel over functions; same bits for
/// any number of threads.
NormalEquations assemble(const spline::Basis& basis, const image::Image& image);

}  // namespace knotreel::fit
