// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/SparseCore>

#include "knotreel/spline/space.h"

/// Corner smoothing (docs/algorithm.md): at multiple knots a TCB-spline of degree k is only continuous,
/// because every mesh edge that ends there carries a jump of the derivatives. The surface is C^{k-1}
/// everywhere off the features exactly if, for every multiple corner A, the control points of the functions
/// whose I holds A are values of the polar form of one polynomial of degree k-1 at the other knots of I.
namespace knotreel::spline {

/// What becomes of functions that belong to two multiple corners, on mesh edges between two multiple knots.
enum class SharedFunctions {
  kTied,  ///< they obey both corners: smooth everywhere, but where such edges are many, little freedom is
          ///< left
  kFree,  ///< they obey none: merely continuous along such an edge and its neighbours
};

/// Prolongation P from free parameters z to the control points c = P z of all smooth surfaces of a space; the
/// same for every colour channel. Columns of functions away from multiple knots are unit vectors; those of
/// corners are orthonormal. With kTied, corners that share functions (mesh edges between two multiple knots)
/// are solved together. Cost: cubic in the number of functions of the largest such group, linear otherwise.
Eigen::SparseMatrix<double> smooth_corner_prolongation(const SplineSpace& space,
                                                       SharedFunctions shared = SharedFunctions::kTied);

}  // namespace knotreel::spline
