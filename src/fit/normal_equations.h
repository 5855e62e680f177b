#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>

#include "knotreel/fit/pixel_values.h"
#include "knotreel/image/image.h"

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
/// @param active  one per function: 0 leaves its row and column zero; or none: all take part.
/// Parallel over functions; same bits for any number of threads.
NormalEquations assemble(const PixelValues& values, const image::Image& target,
                         std::span<const float> weights, std::span<const std::uint8_t> active = {});

}  // namespace knotreel::fit
