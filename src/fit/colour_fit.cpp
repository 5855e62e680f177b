#include "knotreel/fit/colour_fit.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "fit/normal_equations.h"
#include "knotreel/base/error.h"
#include "knotreel/spline/smooth_corners.h"

namespace knotreel::fit {

namespace {

/// Colours of the picture at the Greville sites: what control points fall back to where pixels say nothing.
Eigen::MatrixXd greville_colours(const spline::SplineSpace& space, const image::Image& image) {
  Eigen::MatrixXd prior(static_cast<Eigen::Index>(space.function_count()), image.channels);
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    const Vec2 site = space.greville(f);
    const int x = std::clamp(static_cast<int>(std::floor(site.x)), 0, image.width - 1);
    const int y = std::clamp(static_cast<int>(std::floor(site.y)), 0, image.height - 1);
    for (int c = 0; c < image.channels; ++c) {
      prior(static_cast<Eigen::Index>(f), c) = static_cast<double>(image.at(x, y, c));
    }
  }
  return prior;
}

Eigen::MatrixXd solve(const Eigen::SparseMatrix<double>& lower, const Eigen::MatrixXd& right) {
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower> factor(lower);
  if (factor.info() != Eigen::Success) {
    throw Error(ErrorKind::kInternal, "the normal equations of the colour fit cannot be factored");
  }
  return factor.solve(right);
}

}  // namespace

std::vector<double> fit_colours(const spline::Basis& basis, const image::Image& image,
                                const ColourFitOptions& options) {
  const spline::SplineSpace& space = basis.space();
  if (space.mesh().width != image.width || space.mesh().height != image.height) {
    throw Error(ErrorKind::kInvalidArgument, "the colour fit needs a knot mesh of the size of the picture");
  }
  NormalEquations normal = assemble(basis, image);
  const double ridge = options.ridge * normal.matrix.diagonal().maxCoeff();
  for (Eigen::Index i = 0; i < normal.matrix.rows(); ++i) normal.matrix.coeffRef(i, i) += ridge;

  // min |A c - b|^2 + ridge |c - prior|^2 over c = P z, with P the identity or the smooth surfaces.
  const Eigen::MatrixXd right = normal.right + ridge * greville_colours(space, image);
  Eigen::MatrixXd control;
  if (options.smooth_corners) {
    const Eigen::SparseMatrix<double> p = spline::smooth_corner_prolongation(space);
    const Eigen::SparseMatrix<double> full = normal.matrix.selfadjointView<Eigen::Lower>();
    const Eigen::SparseMatrix<double> reduced = p.transpose() * full * p;
    control = p * solve(reduced.triangularView<Eigen::Lower>(), p.transpose() * right);
  } else {
    control = solve(normal.matrix, right);
  }
  std::vector<double> colours(static_cast<std::size_t>(control.size()));
  Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      colours.data(), control.rows(), control.cols()) = control;
  return colours;
}

}  // namespace knotreel::fit
