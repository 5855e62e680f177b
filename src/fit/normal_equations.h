#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>

#include "knotreel/image/image.h"
#include "knotreel/spline/pixel_values.h"

namespace knotreel::fit {

/// A^T W A and A^T W b of the least-squares problem A c = b, row = pixel, column = function, with a diagonal
/// W.
struct NormalEquations {
  Eigen::SparseMatrix<double>
      matrix;             ///< lower triangle, functions x functions; the diagonal is always there
  Eigen::MatrixXd right;  ///< functions x channels
};

/// @param target  b: one sample per pixel and channel.
/// @param weights one per pixel, or none: all 1.
/// @tparam Value double or float: what functions are evaluated in, and their products over a tile of 8 x 8
///               pixels summed; these sums are added up in double precision.
/// Parallel over tiles and functions; same bits for any number of threads. Memory: some 40 bytes per pixel.
template <class Value>
NormalEquations assemble(const spline::PixelValues& values, const image::Image& target,
                         std::span<const float> weights);

}  // namespace knotreel::fit
