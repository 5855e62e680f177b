// SPDX-License-Identifier: GPL-3.0-or-later
#include "knotreel/fit/colour_fit.h"

#include <Eigen/SparseCore>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "fit/colour_steps.h"
#include "fit/mixed_equations.h"
#include "fit/normal_equations.h"
#include "fit/reduced_system.h"
#include "knotreel/base/error.h"
#include "knotreel/base/parallel.h"
#include "knotreel/spline/smooth_corners.h"
#include "knotreel/spline/surface.h"

namespace knotreel::fit {

namespace {

// How near to the solution control points with a start are looked for, levels; or in steps, where coordinate
// descent in steps mends what is left.
constexpr double kTolerance = 0.01;
constexpr double kToleranceOfStep = 2;

/// Colours of the picture at the Greville sites of some functions: what control points fall back to where
/// pixels say nothing.
Eigen::MatrixXd greville_colours(const spline::SplineSpace& space,
                                 std::span<const spline::FunctionIndex> functions,
                                 const image::Image& image) {
  Eigen::MatrixXd prior(static_cast<Eigen::Index>(functions.size()), image.channels);
  for (std::size_t i = 0; i < functions.size(); ++i) {
    const Vec2 site = space.greville(functions[i]);
    const double column = site.x * image.width / space.mesh().width;
    const double row = site.y * image.height / space.mesh().height;
    const int x = std::clamp(static_cast<int>(std::floor(column)), 0, image.width - 1);
    const int y = std::clamp(static_cast<int>(std::floor(row)), 0, image.height - 1);
    for (int c = 0; c < image.channels; ++c) {
      prior(static_cast<Eigen::Index>(i), c) = static_cast<double>(image.at(x, y, c));
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

/// What is given by function, of those that are looked for.
std::vector<double> of_sought(std::span<const double> numbers, const Sought& sought, std::size_t channels) {
  if (numbers.empty() || sought.all()) return {numbers.begin(), numbers.end()};
  std::vector<double> result;
  result.reserve(sought.functions.size() * channels);
  for (const spline::FunctionIndex f : sought.functions) {
    const auto first = numbers.begin() + static_cast<std::ptrdiff_t>(f * channels);
    result.insert(result.end(), first, first + static_cast<std::ptrdiff_t>(channels));
  }
  return result;
}

/// Where the solution is looked for; empty if nothing is known.
/// @param prior what is known without.
Eigen::MatrixXd start_of(std::span<const double> start, const Eigen::MatrixXd& prior) {
  if (start.empty()) return {};
  const Eigen::Map<const RowMajor> known(start.data(), prior.rows(), prior.cols());
  return known.array().isNaN().select(prior, known);
}

/// The rows of the functions that are looked for, and the columns that they have.
Eigen::SparseMatrix<double> of_sought(const Eigen::SparseMatrix<double>& p, const Sought& sought) {
  std::vector<Eigen::Triplet<double>> entries;
  int columns = 0;
  for (int j = 0; j < p.outerSize(); ++j) {
    bool any = false;
    for (Eigen::SparseMatrix<double>::InnerIterator e(p, j); e; ++e) {
      if (!sought.has(static_cast<spline::FunctionIndex>(e.row()))) continue;
      any = true;
      entries.emplace_back(static_cast<int>(sought.number_of[static_cast<std::size_t>(e.row())]), columns,
                           e.value());
    }
    columns += any ? 1 : 0;
  }
  Eigen::SparseMatrix<double> result(static_cast<Eigen::Index>(sought.functions.size()), columns);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

/// Lets go of fixed functions that share a column of P with others that are not.
void free_partners(const Eigen::SparseMatrix<double>& p, std::vector<std::uint8_t>& fixed) {
  for (bool any = true; any;) {
    any = false;
    for (int j = 0; j < p.outerSize(); ++j) {
      const auto rows =
          std::span(p.innerIndexPtr() + p.outerIndexPtr()[j], p.innerIndexPtr() + p.outerIndexPtr()[j + 1]);
      const auto is_fixed = [&](int row) { return fixed[static_cast<std::size_t>(row)] != 0; };
      if (rows.size() < 2 || std::all_of(rows.begin(), rows.end(), is_fixed) ||
          std::none_of(rows.begin(), rows.end(), is_fixed))
        continue;
      for (const int row : rows) fixed[static_cast<std::size_t>(row)] = 0;
      any = true;
    }
  }
}

void check_sizes(const spline::SplineSpace& space, const Pixels& pixels, const ColourFitOptions& options) {
  if (!pixels.weights.empty() && pixels.weights.size() != pixels.image->pixel_count())
    throw Error(ErrorKind::kInvalidArgument, "a fit needs one weight per pixel");
  const std::size_t points = space.function_count() * static_cast<std::size_t>(pixels.image->channels);
  if (!options.start.empty() && options.start.size() != points)
    throw Error(ErrorKind::kInvalidArgument, "a fit needs one start per control point");
  if (!options.reluctance.empty() && options.reluctance.size() != space.function_count())
    throw Error(ErrorKind::kInvalidArgument, "control points are reluctant by one number per function");
  if (options.fixed.empty()) return;
  if (options.fixed.size() != space.function_count() || options.start.empty())
    throw Error(ErrorKind::kInvalidArgument, "control points stay at their start by one flag per function");
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

/// min |A c - b|^2 + ridge |c - prior|^2 over c = P z.
/// @param control all; those that are looked for are changed.
void solve(const spline::SplineSpace& space, const image::Image& image, NormalEquations& normal,
           const Eigen::SparseMatrix<double>& p, const Sought& sought, const ColourFitOptions& options,
           std::vector<double>& control) {
  const auto channels = static_cast<std::size_t>(image.channels);
  const double ridge = options.ridge * std::max(1.0, normal.matrix.diagonal().maxCoeff());
  for (Eigen::Index i = 0; i < normal.matrix.rows(); ++i) normal.matrix.coeffRef(i, i) += ridge;
  const Eigen::MatrixXd prior = greville_colours(space, sought.functions, image);
  const Eigen::MatrixXd right = normal.right + ridge * prior;
  const std::vector<double> start = of_sought(options.start, sought, channels);
  const double tolerance = std::max(kTolerance, kToleranceOfStep * options.step);
  const Eigen::MatrixXd found = solve_reduced(normal.matrix, p, right, start_of(start, prior), tolerance);
  std::vector<double> result(static_cast<std::size_t>(found.size()));
  Eigen::Map<RowMajor>(result.data(), found.rows(), found.cols()) = found;
  if (options.step > 0) {
    const std::vector<double> reluctance = of_sought(options.reluctance, sought, 1);
    descend_in_steps(normal.matrix, right, on_their_own(p), start, {options.step, reluctance}, result);
  }
  for (std::size_t i = 0; i < sought.functions.size(); ++i) {
    std::copy_n(result.begin() + static_cast<std::ptrdiff_t>(i * channels), channels,
                control.begin() + static_cast<std::ptrdiff_t>(sought.functions[i] * channels));
  }
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
  const auto channels = static_cast<std::size_t>(image.channels);
  check_sizes(space, pixels, options);
  ColourFit fit;
  fit.control.assign(options.start.begin(), options.start.end());
  fit.control.resize(space.function_count() * channels);

  NormalEquations normal;
  Eigen::SparseMatrix<double> p;
  std::vector<std::uint8_t> fixed(options.fixed.begin(), options.fixed.end());
  if (!fixed.empty()) {
    p = prolongation(space, options.smooth_corners);
    free_partners(p, fixed);
  }
  const Sought sought(space.function_count(), fixed, options.start);
  const bool single = options.precision == Precision::kSingle;
  if (!sought.functions.empty()) {
    NormalEquations mixed;
    parallel_invoke(
        [&] {
          normal = single ? assemble<float>(values, image, pixels.weights, sought)
                          : assemble<double>(values, image, pixels.weights, sought);
        },
        [&] {
          if (fixed.empty()) p = prolongation(space, options.smooth_corners);
          if (!sought.all()) p = of_sought(p, sought);
          if (pixels.mixed) mixed = mixed_equations(values.basis(), *pixels.mixed, sought, image.channels);
        });
    if (pixels.mixed) {
      normal.matrix += mixed.matrix;
      normal.right += mixed.right;
    }
    solve(space, image, normal, p, sought, options, fit.control);
  }
  if (options.find_residual) {
    fit.residual = single ? residual_in<float>(values, image, fit.control)
                          : residual_in<double>(values, image, fit.control);
    fit.squared_error = squared_error(fit.residual, pixels);
  }
  return fit;
}

}  // namespace knotreel::fit
