#pragma once

#include <Eigen/SparseCore>

#include "knotreel/spline/space.h"

/// Corner smoothing (docs/algorithm.md): at multiple knots a TCB-spline of degree k is only continuous,
/// because every mesh edge that ends there carries a jump of the derivatives. The surface is C^{k-1}
/// everywhere off the features exactly if, for every multiple corner A, the control points of the functions
/// whose I holds A are values of the polar form of one polynomial of degree k-1 at the other knots of I.
namespace knotreel::spline {

/// Prolongation P from free parameters z to the control points c = P z of all smooth surfaces of a space; the
/// same for every colour channel. Columns of functions away from multiple knots are unit vectors; those of
/// corners are orthonormal. Corners that share functions (mesh edges between two multiple knots) are solved
/// together. Cost: cubic in the number of functions of the largest such group, linear otherwise.
Eigen::SparseMatrix<double> smooth_corner_prolongation(const SplineSpace& space);

}  // namespace knotreel::spline
