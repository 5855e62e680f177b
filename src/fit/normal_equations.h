// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <cstdint>
#include <span>
#include <vector>

#include "knotreel/image/image.h"
#include "knotreel/spline/pixel_values.h"

namespace knotreel::fit {

/// A^T W A and A^T W b of the least-squares problem A c = b, row = pixel, column = function, with a diagonal
/// W.
struct NormalEquations {
  Eigen::SparseMatrix<double> matrix;  ///< lower triangle, sought x sought; the diagonal is always there
  Eigen::MatrixXd right;               ///< sought x channels
};

/// Which control points are looked for.
struct Sought {
  std::vector<spline::FunctionIndex> functions;  ///< ascending
  std::vector<std::uint32_t> number_of;          ///< by function: its place among them, or kKnown
  std::span<const double> known;                 ///< control points by function; of the known ones only

  static constexpr std::uint32_t kKnown = 0xffffffff;

  /// @param fixed 1 for functions whose control points are known; or none: all are unknown.
  Sought(std::size_t functions, std::span<const std::uint8_t> fixed, std::span<const double> known);

  bool all() const { return functions.size() == number_of.size(); }
  bool has(spline::FunctionIndex f) const { return number_of[f] != kKnown; }
};

/// @param target  b: one sample per pixel and channel.
/// @param weights one per pixel, or none: all 1.
/// @param sought what known control points make is taken off b. Only tiles with unknown ones are looked at.
/// @tparam Value double or float: what functions are evaluated in, and their products over a tile of 8 x 8
///               pixels summed; these sums are added up in double precision.
/// Parallel over tiles and functions; same bits for any number of threads. Memory: some 40 bytes per pixel.
template <class Value>
NormalEquations assemble(const spline::PixelValues& values, const image::Image& target,
                         std::span<const float> weights, const Sought& sought);
/// The same with all control points unknown.
template <class Value>
NormalEquations assemble(const spline::PixelValues& values, const image::Image& target,
                         std::span<const float> weights) {
  return assemble<Value>(values, target, weights, Sought(values.basis().space().function_count(), {}, {}));
}

}  // namespace knotreel::fit
