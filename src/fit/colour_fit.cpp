#include "knotreel/fit/colour_fit.h"

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "fit/colour_steps.h"
#include "fit/normal_equations.h"
#include "fit/reduced_system.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/spline/smooth_corners.h"
#include "knotreel/spline/surface.h"

namespace knotreel::fit {

namespace {

// How near to the solution control points with a start are looked for, levels, or in steps.
constexpr double kTolerance = 0.01;
constexpr double kToleranceOfStep = 0.1;

/// Colours of the picture at the Greville sites: what control points fall back to where pixels say nothing.
Eigen::MatrixXd greville_colours(const spline::SplineSpace& space, const image::Image& image) {
  Eigen::MatrixXd prior(static_cast<Eigen::Index>(space.function_count()), image.channels);
  for (spline::FunctionIndex f = 0; f < space.function_count(); ++f) {
    const Vec2 site = space.greville(f);
    const double column = site.x * image.width / space.mesh().width;
    const double row = site.y * image.height / space.mesh().height;
    const int x = std::clamp(static_cast<int>(std::floor(column)), 0, image.width - 1);
    const int y = std::clamp(static_cast<int>(std::floor(row)), 0, image.height - 1);
    for (int c = 0; c < image.channels; ++c) {
      prior(static_cast<Eigen::Index>(f), c) = static_cast<double>(image.at(x, y, c));
    }
  }
  return prior;
}

/// The identity, or onto the surfaces that are smooth at corners.
Eigen::SparseMatrix<double> prolongation(const spline::SplineSpace& space, bool smooth_corners) {
  if (smooth_corners) return spline::smooth_corner_prolongation(space, spline::SharedFunctions::kFree);
  const auto n = static_cast<Eigen::Index>(space.function_count());
  Eigen::SparseMatrix<double> identity(n, n);
  identity.setIdentity();
  return identity;
}

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Where the solution is looked for; empty if nothing is known.
/// @param prior what is known without.
Eigen::MatrixXd start_of(std::span<const double> start, const Eigen::MatrixXd& prior) {
  if (start.empty()) return {};
  if (start.size() != static_cast<std::size_t>(prior.size()))
    throw Error(ErrorKind::kInvalidArgument, "a fit needs one start per control point");
  const Eigen::Map<const RowMajor> known(start.data(), prior.rows(), prior.cols());
  return known.array().isNaN().select(prior, known);
}

/// By function: whether it is a column of P, and in no other row of it.
std::vector<std::uint8_t> on_their_own(const Eigen::SparseMatrix<double>& p) {
  std::vector<int> in_row(static_cast<std::size_t>(p.rows()), 0);
  for (Eigen::Index k = 0; k < p.nonZeros(); ++k) ++in_row[static_cast<std::size_t>(p.innerIndexPtr()[k])];
  std::vector<std::uint8_t> own(in_row.size(), 0);
  for (int j = 0; j < p.outerSize(); ++j) {
    const int first = p.outerIndexPtr()[j];
    const auto row = static_cast<std::size_t>(p.innerIndexPtr()[first]);
    if (p.outerIndexPtr()[j + 1] - first == 1 && in_row[row] == 1) own[row] = 1;
  }
  return own;
}

template <class Value>
std::vector<float> residual_in(const spline::PixelValues& values, const image::Image& image,
                               std::span<const double> control) {
  constexpr std::size_t kPixels = spline::PixelValues::kTilePixels;
  const auto channels = static_cast<std::size_t>(image.channels);
  std::vector<float> residual(image.samples.size());
  const auto add_tile = [&](std::size_t t, const spline::TileSurface<Value>& surface) {
    values.for_pixels(t, [&](std::size_t pixel, std::size_t place) {
      for (std::size_t c = 0; c < channels; ++c) {
        const std::size_t i = pixel * channels + c;
        residual[i] = static_cast<float>(static_cast<Value>(image.samples[i]) - surface[c * kPixels + place]);
      }
    });
  };
  spline::for_surface_tiles<Value>(values, {control, image.channels}, add_tile);
  return residual;
}

double squared_error(std::span<const float> residual, const Pixels& pixels) {
  const std::size_t row_size = pixels.image->row_size();
  std::vector<double> row_sums(static_cast<std::size_t>(pixels.image->height), 0.0);
  parallel_for(row_sums.size(), [&](std::size_t y) {
    double sum = 0;
    for (std::size_t i = y * row_size; i < (y + 1) * row_size; ++i) {
      const auto d = static_cast<double>(residual[i]);
      sum += pixels.weights.empty()
                 ? d * d
                 : d * d * static_cast<double>(pixels.weights[i / std::size_t(pixels.image->channels)]);
    }
    row_sums[y] = sum;
  });
  return std::accumulate(row_sums.begin(), row_sums.end(), 0.0);
}

}  // namespace

ColourFit fit_colours(const spline::Basis& basis, const Pixels& pixels, const ColourFitOptions& options) {
  const spline::PixelValues values(basis, pixels.image->width, pixels.image->height, pixels.places);
  return fit_colours(values, pixels, options);
}

ColourFit fit_colours(const spline::PixelValues& values, const Pixels& pixels,
                      const ColourFitOptions& options) {
  const spline::SplineSpace& space = values.basis().space();
  const image::Image& image = *pixels.image;
  if (!pixels.weights.empty() && pixels.weights.size() != image.pixel_count()) {
    throw Error(ErrorKind::kInvalidArgument, "a fit needs one weight per pixel");
  }
  NormalEquations normal;
  Eigen::SparseMatrix<double> p;
  const bool single = options.precision == Precision::kSingle;
  parallel_invoke(
      [&] {
        normal = single ? assemble<float>(values, image, pixels.weights)
                        : assemble<double>(values, image, pixels.weights);
      },
      [&] { p = prolongation(space, options.smooth_corners); });
  const double ridge = options.ridge * std::max(1.0, normal.matrix.diagonal().maxCoeff());
  for (Eigen::Index i = 0; i < normal.matrix.rows(); ++i) normal.matrix.coeffRef(i, i) += ridge;

  // min |A c - b|^2 + ridge |c - prior|^2 over c = P z.
  const Eigen::MatrixXd prior = greville_colours(space, image);
  const Eigen::MatrixXd right = normal.right + ridge * prior;
  const double tolerance = std::max(kTolerance, kToleranceOfStep * options.step);
  const Eigen::MatrixXd control =
      solve_reduced(normal.matrix, p, right, start_of(options.start, prior), tolerance);
  ColourFit fit;
  fit.control.resize(static_cast<std::size_t>(control.size()));
  Eigen::Map<RowMajor>(fit.control.data(), control.rows(), control.cols()) = control;
  if (options.step > 0) {
    descend_in_steps(normal.matrix, right, on_their_own(p), options.start, {options.step, options.reluctance},
                     fit.control);
  }
  if (options.find_residual) {
    fit.residual = single ? residual_in<float>(values, image, fit.control)
                          : residual_in<double>(values, image, fit.control);
    fit.squared_error = squared_error(fit.residual, pixels);
  }
  return fit;
}

}  // namespace knotreel::fit
